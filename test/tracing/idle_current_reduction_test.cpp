// A drive that cuts its current while its axis stands: seen where axes stop and go on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "knee_robot/tracing/candidate.h"
#include "test/identification/synthetic.h"
#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

class IdleCurrentReduction : public testing::Test {
 protected:
  static constexpr double kPeriod_s = 0.01;

  IdleCurrentReduction() { input_.observation = &observation_; }
  /// Moves at 20 mm/s for a second, then stands for two, `times`; 100 N are needed throughout.
  void stopAndGo(int times) {
    recording::Signals& s = observation_.signals;
    s.period_s = kPeriod_s;
    s.velocity_m_per_s = Eigen::MatrixXd::Zero(300 * times, 1);
    for (int n = 0; n < 300 * times; ++n) {
      s.time_s.push_back(kPeriod_s * n);
      if (n % 300 < 100) s.velocity_m_per_s(n, 0) = 0.02;
    }
    s.force_N = s.position_m = Eigen::MatrixXd::Zero(300 * times, 1);
    input_.friction_position_m.resize(300 * times, 1);
    for (int n = 0; n < 300 * times; ++n)
      input_.friction_position_m(n, 0) = kPeriod_s * s.velocity_m_per_s.topRows(n).sum();
    input_.needed_N = Eigen::MatrixXd::Constant(300 * times, 1, 100.0);
  }
  const Candidate& idle() const {
    return **std::find_if(all_.begin(), all_.end(),
                          [](const auto& c) { return c->name() == "idle_current_reduction"; });
  }

  const CandidateList all_ = namedCandidates(identification::syntheticRobot());
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(IdleCurrentReduction, IsLookedForWhereAnAxisStandsSeveralTimes) {
  stopAndGo(3);
  EXPECT_TRUE(idle().shownIn(input_, 0));
}

TEST_F(IdleCurrentReduction, IsNotLookedForInTwoRests) {
  stopAndGo(2);
  EXPECT_FALSE(idle().shownIn(input_, 0));
}

TEST_F(IdleCurrentReduction, TakesNothingInMotionAndComesUpAfterAWhileOfRest) {
  stopAndGo(3);
  const Eigen::VectorXd taken = idle().columns(input_, 0, {0.002, 0.5, 0.2}).col(0);
  EXPECT_EQ(taken[50], 0.0) << "the recording begins in motion";
  EXPECT_EQ(taken[145], 0.0) << "stands for 0.46 s";
  EXPECT_NEAR(taken[168], 100.0 * (1.0 - std::exp(-1.0)), 3.0) << "a time constant after 0.5 s";
  EXPECT_GT(taken[299], 99.0);
  EXPECT_LT(taken[330], 6.0) << "0.3 s of motion later";
}

TEST_F(IdleCurrentReduction, IsNotToldFromWhatFrictionHoldsBeforeAnAxisFirstMovesButIsPredictedThere) {
  stopAndGo(3);
  observation_.signals.velocity_m_per_s.topRows(100).setZero();
  input_.friction_position_m.topRows(300).setZero();
  const std::vector<double> shape = {0.002, 0.5, 0.2};
  EXPECT_EQ(idle().columns(input_, 0, shape)(250, 0), 0.0);
  EXPECT_GT(idle().columns(input_, 0, shape)(590, 0), 90.0) << "the next rest";
  input_.recording = -1;
  EXPECT_GT(idle().columns(input_, 0, shape)(250, 0), 99.0);
}

TEST(Trace, NamesADriveThatCutsItsCurrentWhileItsAxisStands) {
  const TracedCase c = traceSimulated(
      "  - {name: near_rest_friction, law: tanh, speed_m_per_s: 0.001}\n"  // stiction would hold what the drive does not
      "  - {name: idle_current_reduction, actuators: [4], cut: 0.15, after_s: 0.3}\n",
      [](recording::Recording&) {}, {kWithStops + 1}, kWithStops + 2);
  const FoundEffect* idle = foundIn(c, "idle_current_reduction");
  ASSERT_NE(idle, nullptr);
  std::cout << "told more by " << idle->coefficients[0] << " of " << 1.0 / 0.85 - 1.0 << "; error " << c.before_N[3]
            << " -> " << c.after_N[3] << " N\n";
  EXPECT_EQ(idle->hypothesis.place.actuator, 3);
  EXPECT_NEAR(idle->coefficients[0], 1.0 / 0.85 - 1.0, 0.03);
  EXPECT_LT(c.after_N[3], 0.5 * c.before_N[3]);
}

}  // namespace
}  // namespace knee_robot::tracing
