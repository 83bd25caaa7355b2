// Friction after reversals can only be seen where an axis turns and goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "knee_robot/tracing/candidate.h"
#include "test/identification/synthetic.h"
#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

class ReversalFriction : public testing::Test {
 protected:
  ReversalFriction() { input_.observation = &observation_; }
  /// Strokes of so long a way, each in 100 samples.
  void strokes(int count, double way_m) {
    const Eigen::Index samples = 100 * count;
    observation_.signals.velocity_m_per_s = Eigen::MatrixXd::Constant(samples, 1, way_m);
    for (int n = 0; n < samples; ++n)
      observation_.signals.time_s.push_back(0.01 * n);
    observation_.signals.force_N = observation_.signals.position_m = Eigen::MatrixXd::Zero(samples, 1);
    input_.share = Eigen::MatrixXd::Ones(samples, 1);
    input_.first_turn = Eigen::VectorXi::Constant(1, 0);
    input_.since_last_reversal_m.resize(samples, 1);
    for (Eigen::Index n = 0; n < samples; ++n)
      input_.since_last_reversal_m(n, 0) = 0.01 * way_m * static_cast<double>(n % 100);
  }
  const Candidate& reversal() const {
    return **std::find_if(all_.begin(), all_.end(), [](const auto& c) { return c->name() == "reversal_friction"; });
  }

  const CandidateList all_ = namedCandidates(identification::syntheticRobot());
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(ReversalFriction, IsLookedForWhereAnAxisTurnsOften) {
  strokes(7, 0.02);
  EXPECT_TRUE(reversal().shownIn(input_, 0));
}

TEST_F(ReversalFriction, IsNotLookedForInFewStrokes) {
  strokes(4, 0.02);
  EXPECT_FALSE(reversal().shownIn(input_, 0));
}

TEST_F(ReversalFriction, IsNotLookedForInStrokesThatWearNothingOff) {
  strokes(20, 0.001);
  EXPECT_FALSE(reversal().shownIn(input_, 0));
}

TEST_F(ReversalFriction, RisesOverOneWayAndFallsOffOverAnother) {
  strokes(1, 0.02);
  const Eigen::VectorXd fallen = reversal().columns(input_, 0, {0.005, 0.0, 0.0, 0.0}).col(0);
  const Eigen::VectorXd humped = reversal().columns(input_, 0, {0.005, 0.001, 0.0, 0.0}).col(0);
  EXPECT_DOUBLE_EQ(fallen[0], 1.0) << "as the law near rest brings it up";
  EXPECT_NEAR(fallen[25], std::exp(-1.0), 1e-12) << "after 5 mm";
  EXPECT_DOUBLE_EQ(humped[0], 0.0);
  EXPECT_NEAR(humped[5], (1.0 - std::exp(-1.0)) * std::exp(-0.2), 1e-12) << "after 1 mm";
}

TEST_F(ReversalFriction, HasOnlyAShareInTheStrokeThatARecordingBeginsWith) {
  strokes(3, 0.02);
  input_.first_turn[0] = 100;
  const Eigen::VectorXd column = reversal().columns(input_, 0, {0.005, 0.0, 0.25, 0.0}).col(0);
  EXPECT_DOUBLE_EQ(column[0], 0.25) << "nobody knows where it began";
  EXPECT_DOUBLE_EQ(column[100], 1.0);
}

TEST(Trace, NamesFrictionThatIsLargerAfterReversals) {
  const TracedCase c =
      traceSimulated("  - {name: reversal_friction, actuators: [2], excess_N: 40, way_m: 0.02, rise_m: 0.003}\n");
  const auto& effects = c.result.effects;
  const auto found = std::find_if(effects.begin(), effects.end(), [](const FoundEffect& e) {
    return e.hypothesis.place.candidate->name() == "reversal_friction";
  });
  ASSERT_NE(found, effects.end());
  EXPECT_EQ(found->hypothesis.place.actuator, 1);
  const std::vector<double>& shape = found->hypothesis.shape;
  std::cout << "way " << shape[0] << " m, rise " << shape[1] << " m, excess " << found->coefficients[0] << " N; error "
            << c.before_N[1] << " -> " << c.after_N[1] << " N\n";
  EXPECT_NEAR(shape[0], 0.02, 0.005);
  EXPECT_NEAR(found->coefficients[0], 40.0, 8.0);
  EXPECT_LT(c.after_N[1], 0.6 * c.before_N[1]);
}

}  // namespace
}  // namespace knee_robot::tracing
