#include "src/tracing/length_response.h"

#include <gtest/gtest.h>

#include "knee_robot/tracing/effect_input.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

using identification::syntheticModel;
using identification::syntheticRecording;
using identification::syntheticRobot;

/// A recording whose legs are longer by these (m) than it says, as their encoders would see it, and one that knows.
identification::Observation seen(const mechanism::Robot& robot, const mechanism::Vector4& longer_m) {
  recording::Recording r = syntheticRecording(robot, syntheticModel(robot), 0, 20.0, [] { return 0.0; });
  r.position_m.rowwise() += longer_m.transpose();
  return identification::observe(robot, identification::columnsOf(robot), r, {});
}

// Independent of the response: the regressor along the path that the legs really take.
TEST(LengthResponse, IsWhatTheWholeModelChangesByWhereALegIsLonger) {
  const mechanism::Robot robot = syntheticRobot();
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const identification::Observation here = seen(robot, mechanism::Vector4::Zero());
  const std::vector<dynamics::FrictionLaw> laws(4);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool rigid = !columns[c].isFriction() && c < static_cast<std::size_t>(dynamics::kInertialParameters);
    if (rigid) parameters[static_cast<Eigen::Index>(c)] = 1.0 + 0.1 * static_cast<double>(c % 7);
  }
  EffectInput input = effectInput(robot, here, laws, 0, 1);
  setModel(input, columns, parameters);
  constexpr double kLonger_m = 2e-4;
  for (int leg = 0; leg < 4; ++leg) {
    const identification::Observation there = seen(robot, kLonger_m * mechanism::Vector4::Unit(leg));
    EffectInput moved = effectInput(robot, there, laws, 0, 1);
    setModel(moved, columns, parameters);
    for (int i = 0; i < 4; ++i) {
      const Eigen::VectorXd change = moved.load_N.col(i) - input.load_N.col(i);
      Eigen::VectorXd response(input.samples());
      for (int n = 0; n < input.samples(); ++n)
        response[n] = kLonger_m * input.by_lengths->at(input, n).stiffness(i, leg);
      EXPECT_LT((response - change).norm(), 0.03 * change.norm()) << "leg " << leg + 1 << ", actuator " << i + 1;
    }
  }
}

}  // namespace
}  // namespace knee_robot::tracing
