// A spring that relaxes along an actuator.
#include <algorithm>
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class ViscoelasticElement : public testing::Test {
 protected:
  ViscoelasticElement() { input_.observation = &observation_; }
  /// Moves at this speed for a second and stands for nine.
  Eigen::VectorXd stretchedBy(double speed_m_per_s, const std::vector<double>& shape) {
    recording::Signals& s = observation_.signals;
    s = {};
    s.period_s = 0.01;
    s.velocity_m_per_s = Eigen::MatrixXd::Zero(1000, 1);
    s.velocity_m_per_s.topRows(100).setConstant(speed_m_per_s);
    s.force_N = s.position_m = Eigen::MatrixXd::Zero(1000, 1);
    for (int n = 0; n < 1000; ++n)
      s.time_s.push_back(s.period_s * n);
    const auto element =
        std::find_if(all_.begin(), all_.end(), [](const auto& c) { return c->name() == "viscoelastic_element"; });
    return (*element)->columns(input_, 0, shape).col(0);
  }

  const CandidateList all_ = namedCandidates(identification::syntheticRobot());
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(ViscoelasticElement, IsStretchedAsFarAsItCannotRelaxMeanwhile) {
  EXPECT_NEAR(stretchedBy(0.02, {30.0, 30.0})[99], 0.02 * (1.0 - std::exp(-0.99 / 30.0)) * 30.0, 1e-9)
      << "nearly the whole way";
  EXPECT_NEAR(stretchedBy(0.02, {0.1, 0.1})[99], 0.02 * 0.1, 1e-6) << "its time times the speed: a viscous friction";
}

TEST_F(ViscoelasticElement, RelaxesAtRestWithTheTimeOfTheSideToWhichItIsStretched) {
  const Eigen::VectorXd lengthened = stretchedBy(0.02, {1.0, 3.0}), shortened = stretchedBy(-0.02, {1.0, 3.0});
  EXPECT_NEAR(lengthened[299] / lengthened[99], std::exp(-2.0), 1e-9);
  EXPECT_NEAR(shortened[299] / shortened[99], std::exp(-2.0 / 3.0), 1e-9);
  EXPECT_GT(lengthened[99], 0.0);
  EXPECT_LT(shortened[99], 0.0);
}

}  // namespace
}  // namespace knee_robot::tracing
