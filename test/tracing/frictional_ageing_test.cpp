// Friction that grows at rest can only be seen where an axis rests and goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

class FrictionalAgeing : public testing::Test {
 protected:
  FrictionalAgeing() { input_.observation = &observation_; }
  /// Moves at `speed` for a second, then stands, five times.
  void stopAndGo(double speed_m_per_s, double stands_s) {
    recording::Signals& s = observation_.signals;
    s.period_s = 0.01;
    const int cycle = static_cast<int>((1.0 + stands_s) / s.period_s);
    const int count = 5 * cycle;
    s.velocity_m_per_s = Eigen::MatrixXd::Zero(count, 1);
    for (int n = 0; n < count; ++n) {
      s.time_s.push_back(s.period_s * n);
      if (n % cycle < 100) s.velocity_m_per_s(n, 0) = speed_m_per_s;
    }
    s.force_N = s.position_m = Eigen::MatrixXd::Zero(count, 1);
    input_.share = Eigen::MatrixXd::Ones(count, 1);
  }
  const Candidate& ageing() const {
    return **std::find_if(all_.begin(), all_.end(), [](const auto& c) { return c->name() == "frictional_ageing"; });
  }

  const CandidateList all_ = namedCandidates(identification::syntheticRobot());
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(FrictionalAgeing, IsLookedForWhereAnAxisRestsAndGoesOn) {
  stopAndGo(0.02, 0.8);
  EXPECT_TRUE(ageing().shownIn(input_, 0));
}

TEST_F(FrictionalAgeing, IsNotLookedForWhereRestsAreShort) {
  stopAndGo(0.02, 0.2);
  EXPECT_FALSE(ageing().shownIn(input_, 0));
}

TEST_F(FrictionalAgeing, IsNotLookedForWhereNothingGoesOnAfterARest) {
  stopAndGo(0.0002, 0.8);
  EXPECT_FALSE(ageing().shownIn(input_, 0)) << "creeping is no motion";
}

TEST_F(FrictionalAgeing, WearsOffOverItsWayAndGrowsWithItsTime) {
  stopAndGo(0.02, 4.0);
  const Eigen::VectorXd aged = ageing().columns(input_, 0, {1.0, 0.005, 0.0}).col(0);
  const double settled = 1.0 / (1.0 + 0.02 / 0.005);  // growth and wear in balance
  EXPECT_NEAR(aged[0], 1.0, 0.05) << "the robot stood before it was recorded";
  EXPECT_NEAR(aged[99], settled + (1.0 - settled) * std::exp(-5.0), 0.01);
  EXPECT_NEAR(aged[199], 1.0 - (1.0 - aged[99]) * std::exp(-1.0), 0.01) << "a second of rest";
}

}  // namespace
}  // namespace knee_robot::tracing
