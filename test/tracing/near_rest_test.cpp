// What another law of friction near rest might do, and what no law can.
#include <gtest/gtest.h>

#include <random>

#include "src/tracing/push_window.h"
#include "src/tracing/search.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSeconds = 24.0;
constexpr int kActuator = 1;

/// A search in two recordings of a machine that has the baseline and nothing else.
class NearRest : public testing::Test {
 protected:
  NearRest() {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.3);
    for (int variant = 0; variant < 2; ++variant)
      data_.recordings.push_back(
          identification::observe(robot_, identification::columnsOf(robot_),
                                  identification::syntheticRecording(robot_, identification::syntheticModel(robot_),
                                                                     variant, kSeconds, [&] { return noise(random); }),
                                  {}));
    data_.stack = makeStack(data_.recordings, {});
    base_ = fitBase(robot_, data_.recordings, data_.stack, identification::columnsOf(robot_), 0);
    BaseFit newtons = base_;
    newtons.noise_N.setOnes();
    data_.all_base_rows = baseRows(newtons, data_.recordings, data_.stack);
    data_.all_force_rows = forceRows(newtons, data_.recordings, data_.stack);
    setAttention(data_, Attention::All);
    for (std::size_t r = 0; r < data_.recordings.size(); ++r) {
      data_.inputs.push_back(effectInput(robot_, data_.recordings[r], base_.friction_laws, static_cast<int>(r), 2));
      setForces(data_.inputs.back(), base_.columns, base_.parameters, {});
    }
    search_.data = &data_;
    search_.base = &base_;
    search_.rms_N = base_.noise_N;
    updateNearRest(search_);
  }

  Hypothesis named(const std::string& name, const std::vector<double>& shape) const {
    for (const auto& candidate : candidates_) {
      if (candidate->name() == name) return {{candidate.get(), candidate->shared() ? -1 : kActuator}, shape};
    }
    return {};
  }
  /// The machine has this besides.
  void add(const Eigen::VectorXd& force_N) { data_.force_rows += force_N; }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const CandidateList candidates_ = namedCandidates(robot_);
  TraceData data_;
  BaseFit base_;
  Search search_;
};

TEST_F(NearRest, FrictionThatIsLargerWhileCreepingIsNoLaw) {
  const Hypothesis stribeck = named("stribeck", {0.015, 0.0});
  add(3.0 * effectRows(data_, stribeck).col(0));
  const double by_difference =
      explained(data_, stribeck, projectModel(search_, {}), search_.rms_N) / static_cast<double>(data_.stack.size());
  const double beyond = shareBeyondLaws(search_, stribeck);
  EXPECT_GT(beyond, 1.3 * by_difference) << "differences of laws of either sign explain most of it";
  EXPECT_GT(beyond, 1.0) << "in squares of the noise";
}

TEST_F(NearRest, FrictionThatBuildsUpOverALongerWayIsALaw) {
  const Hypothesis stribeck = named("stribeck", {0.015, 0.0});
  const Eigen::Index laws = search_.near_rest.cols() / data_.stack.axes, stop_of_200_um = 2;
  add(3.0 * search_.near_rest.col(kActuator * laws + stop_of_200_um));
  EXPECT_LT(shareBeyondLaws(search_, stribeck), 0.05);
}

TEST_F(NearRest, NothingPushesBeforeEveryActuatorHasMoved) {
  const EffectInput& input = data_.inputs[0];
  const Hypothesis push = named("external_force", {1.0, 0.0, 4.0});
  const Eigen::MatrixXd columns = effectColumns(input, push, kActuator);
  const Eigen::MatrixXd& q = input.friction_position_m;
  int settled = 0;
  for (int n = 0; n < input.samples() && settled == 0; ++n) {
    if (((q.row(n) - q.row(0)).cwiseAbs().array() > 3e-4).all()) settled = n;
  }
  ASSERT_GT(settled, 10);
  EXPECT_EQ(columns.topRows(settled - 5).norm(), 0.0);
  EXPECT_GT(columns.row(settled + 5).norm(), 0.0);
}

}  // namespace
}  // namespace knee_robot::tracing
