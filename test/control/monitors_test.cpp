// One test a failure that a monitor is there to prevent, and one that it does not see ghosts.
#include "src/control/monitors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::control {
namespace {

constexpr double kDt = 1e-3;
AxisView quiet() {
  AxisView view;
  view.dt = kDt;
  view.force_limit_N = 270.0;
  return view;
}

/// Cycles until `step` answers true, at most `limit`.
template <typename Step>
int cyclesUntil(Step&& step, int limit) {
  for (int i = 1; i <= limit; ++i) {
    if (step()) return i;
  }
  return -1;
}

TEST(EncoderJump, IsSeenInItsOwnCycleAndAPauseOfTheMachineIsNone) {
  EncoderJumpMonitor monitor;
  AxisView view = quiet();
  view.moved_m = 0.3 * kDt;
  EXPECT_FALSE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005));
  view.moved_m = -0.003;
  EXPECT_TRUE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005));
  view.dt = 0.030;
  view.moved_m = 0.009;
  EXPECT_FALSE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005)) << "30 ms at full speed";
  view.moved_m = kNan;
  EXPECT_TRUE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005));
}

TEST(EncoderJump, IsWhatAnAxisMovedByTooFarWhileNobodyCouldReadItHoweverLongThatTook) {
  EncoderJumpMonitor monitor;
  AxisView view = quiet();
  view.dt = 2.0;
  view.moved_m = 0.2;
  EXPECT_FALSE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005)) << "a process that was stopped: the card went on counting";
  view.after_gap = true;
  EXPECT_TRUE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005));
  view.moved_m = -0.004;
  EXPECT_FALSE(monitor.step(view, 0.3, 4.0, 1e-3, 0.005)) << "while the brakes engaged";
}

TEST(EncoderNoise, IsSeenWithinSomeCyclesAndNoOscillationThatAnAxisCanMakeIsNoise) {
  const double count_m = 2e-5;
  EncoderNoiseMonitor monitor;
  AxisView view = quiet();
  double sign = 1.0;
  const auto noise = [&] {
    view.moved_m = (sign = -sign) * 2.0 * count_m;
    return monitor.step(view, count_m);
  };
  const int cycles = cyclesUntil(noise, 100);
  EXPECT_GT(cycles, 5);
  EXPECT_LT(cycles, 20);
  EncoderNoiseMonitor calm;
  const auto dither = [&] {
    view.moved_m = (sign = -sign) * count_m;
    return calm.step(view, count_m);
  };
  EXPECT_EQ(cyclesUntil(dither, 10000), -1) << "one count, at a slot's edge";
  int k = 0;
  const auto unstable = [&] {
    view.moved_m = (++k / 8 % 2 == 0 ? 1.0 : -1.0) * 10.0 * count_m;
    return calm.step(view, count_m);
  };
  EXPECT_EQ(cyclesUntil(unstable, 10000), -1) << "62 Hz, 1.6 mm: a loop that is unstable, others see it";
}

TEST(EncoderFrozen, IsSeenWhenTheReferenceMovesOnAndNotAtRest) {
  EncoderFrozenMonitor monitor;
  AxisView view = quiet();
  const auto step = [&] { return monitor.step(view, 0.002, 40.0) == EncoderFrozenMonitor::Verdict::Dead; };
  EXPECT_EQ(cyclesUntil(step, 10000), -1) << "standing still for ten seconds is no fault";
  const auto moving = [&] {
    view.reference_m += 0.02 * kDt;
    view.force_N += 60000.0 * 0.02 * kDt;
    return step();
  };
  EXPECT_NEAR(cyclesUntil(moving, 1000), 100, 2) << "2 mm at 20 mm/s";
  monitor.reset();
  int dither = 0;
  const auto disconnected = [&] {
    view.moved_m = ++dither % 2 == 0 ? 40e-6 : -40e-6;
    return moving();
  };
  EXPECT_NEAR(cyclesUntil(disconnected, 1000), 100, 2) << "open inputs dither";
}

TEST(EncoderFrozen, IsNotAnAxisThatIsBackWhereItWasBehindATurningPoint) {
  EncoderFrozenMonitor monitor;
  AxisView view = quiet();
  int cycle = 0;
  const auto turning = [&] {
    ++cycle;
    const double way = cycle <= 60 ? 0.02 * kDt : -0.02 * kDt;  // 1.2 mm there, then back beyond the start
    view.reference_m += way;
    // It follows there, sticks for 1.2 mm behind the turning point, then slips back: at -2 mm it is where it was.
    view.moved_m = cycle <= 60 ? way : cycle > 120 && cycle <= 130 ? -0.12e-3 : 0.0;
    view.force_N = cycle <= 60 ? 60.0 : -60.0;
    return monitor.step(view, 0.002, 105.0) == EncoderFrozenMonitor::Verdict::Dead;
  };
  EXPECT_EQ(cyclesUntil(turning, 165), -1);
}

TEST(EncoderFrozen, IsAskedFirstWhereTheDriverCanAndDeadOnlyWhenItStaysSilent) {
  using Verdict = EncoderFrozenMonitor::Verdict;
  EncoderFrozenMonitor monitor;
  AxisView view = quiet();
  view.can_be_asked = true;
  Verdict verdict = Verdict::Counts;
  const auto moving = [&] {
    view.reference_m += 0.02 * kDt;
    view.force_N += 60000.0 * 0.02 * kDt;
    verdict = monitor.step(view, 0.002, 40.0);
    return verdict != Verdict::Counts;
  };
  EXPECT_NEAR(cyclesUntil(moving, 1000), 100, 2);
  EXPECT_EQ(verdict, Verdict::Ask);
  view.answers = 1;
  EXPECT_NEAR(cyclesUntil(moving, 1000), 100, 2) << "an answer begins anew";
  EXPECT_EQ(verdict, Verdict::Ask);
  view.force_N = 0.0;
  const auto silent = [&] { return monitor.step(view, 0.002, 40.0) == Verdict::Dead; };
  EXPECT_NEAR(cyclesUntil(silent, 1000), 1000 * EncoderFrozenMonitor::kSilence_s, 2)
      << "once suspected, whatever the force does";
}

TEST(EncoderFrozen, IsNotSeenInSlowMotionOfFewCountsNorInStickingFriction) {
  EncoderFrozenMonitor monitor;
  AxisView view = quiet();
  int cycle = 0;
  const auto slow = [&] {
    view.reference_m += 0.001 * kDt;
    view.moved_m = ++cycle % 20 == 0 ? 20e-6 : 0.0;  // 1 mm/s with 20 um counts: mostly no count at all
    return monitor.step(view, 0.002, 40.0) == EncoderFrozenMonitor::Verdict::Dead;
  };
  EXPECT_EQ(cyclesUntil(slow, 10000), -1);
  monitor.reset();
  view.moved_m = 0.0;
  view.force_N = 0.0;
  const auto sticking = [&] {
    view.reference_m += 0.01 * kDt;
    view.force_N = std::min(35.0, view.force_N + 0.1);  // the axis has not broken away yet
    return monitor.step(view, 0.002, 40.0) == EncoderFrozenMonitor::Verdict::Dead;
  };
  EXPECT_EQ(cyclesUntil(sticking, 500), -1);
}

TEST(Velocity, IsLimitedWithRoomForNoise) {
  VelocityMonitor monitor;
  AxisView view = quiet();
  view.velocity = 0.3;
  EXPECT_EQ(cyclesUntil([&] { return monitor.step(view, 0.3, 1.3, 0.02, 0.005); }, 100), -1);
  view.velocity = -0.45;
  EXPECT_EQ(cyclesUntil([&] { return monitor.step(view, 0.3, 1.3, 0.02, 0.005); }, 100), 5);
  monitor.reset();
  view.velocity = kNan;
  EXPECT_GT(cyclesUntil([&] { return monitor.step(view, 0.3, 1.3, 0.02, 0.005); }, 100), 0);
}

TEST(Acceleration, IsLimitedOverAWindowSoThatOneCountIsNone) {
  AccelerationMonitor monitor;
  AxisView view = quiet();
  int cycle = 0;
  const auto noisy = [&] {
    view.velocity =
        ++cycle % 2 == 0 ? 0.006 : 0.0;  // 20 um in 1 ms behind a 60 Hz low-pass: 6 m/s2 from cycle to cycle
    return monitor.step(view, 5.0);
  };
  EXPECT_EQ(cyclesUntil(noisy, 1000), -1);
  const auto hit = [&] {
    view.velocity += 20.0 * kDt;
    return monitor.step(view, 15.0);
  };
  EXPECT_GT(cyclesUntil(hit, 100), 0);
}

TEST(SoftLimit, IsBrokenOutwardsOnlySoThatTheWayBackIsOpen) {
  SoftLimitMonitor monitor;
  AxisView view = quiet();
  view.position_m = 0.902;
  view.velocity = 0.01;
  EXPECT_TRUE(monitor.step(view, 0.6, 0.9, 5e-4, 2e-3));
  view.velocity = -0.01;
  EXPECT_FALSE(monitor.step(view, 0.6, 0.9, 5e-4, 2e-3));
  view.position_m = 0.598;
  EXPECT_TRUE(monitor.step(view, 0.6, 0.9, 5e-4, 2e-3));
  view.position_m = 0.75;
  EXPECT_FALSE(monitor.step(view, 0.6, 0.9, 5e-4, 2e-3));
  view.position_m = kNan;
  view.velocity = kNan;
  EXPECT_TRUE(monitor.step(view, 0.6, 0.9, 5e-4, 2e-3));
}

TEST(Stall, NeedsForceStandstillAndDistanceForItsTime) {
  StallMonitor monitor;
  AxisView view = quiet();
  view.force_N = -200.0;
  view.reference_m = -0.004;
  const auto step = [&] { return monitor.step(view, 0.6, 1e-3, 1e-3, 0.3); };
  EXPECT_NEAR(cyclesUntil(step, 1000), 300, 1);
  monitor.reset();
  view.reference_m = 0.0;
  EXPECT_EQ(cyclesUntil(step, 2000), -1) << "carrying a heavy load at rest is no stall";
  view.reference_m = -0.004;
  view.velocity = -0.02;
  EXPECT_EQ(cyclesUntil(step, 2000), -1) << "it moves";
}

TEST(Saturation, IsToleratedForATimeAndThenNot) {
  SaturationMonitor monitor;
  AxisView view = quiet();
  view.force_N = 270.0;
  EXPECT_NEAR(cyclesUntil([&] { return monitor.step(view, 0.25); }, 1000), 250, 1);
  view.force_N = 200.0;
  EXPECT_FALSE(monitor.step(view, 0.25));
  view.force_N = -270.0;
  EXPECT_NEAR(cyclesUntil([&] { return monitor.step(view, 0.25); }, 1000), 250, 1) << "counts anew";
}

TEST(Thermal, LetsTheContinuousForceGoOnForeverAndAPeakForSeconds) {
  ThermalMonitor monitor;
  AxisView view = quiet();
  view.force_N = 118.0;
  EXPECT_EQ(cyclesUntil([&] { return monitor.step(view, 118.0, 20.0); }, 600'000), -1) << "ten minutes";
  EXPECT_NEAR(monitor.heat(), 1.0, 1e-6);
  monitor.start(0.0);
  view.force_N = -300.0;
  const int cycles = cyclesUntil([&] { return monitor.step(view, 118.0, 20.0); }, 600'000);
  const double ratio = 300.0 * 300.0 / (118.0 * 118.0);
  EXPECT_NEAR(1e-3 * cycles, 20.0 * std::log(ratio / (ratio - 1.0)), 0.01) << "-tau ln(1 - 1 / ratio)";
  monitor.start(0.0);
  view.force_N = 568.0;
  EXPECT_FALSE(monitor.step(view, 0.0, 20.0)) << "a robot file without continuous force has no such limit";
}

TEST(Thermal, CoolsDownWithTheDrivesOff) {
  ThermalMonitor monitor;
  monitor.start(1.2);
  AxisView view = quiet();
  EXPECT_TRUE(monitor.step(view, 118.0, 20.0));
  for (int i = 0; i < 20'000; ++i)
    monitor.step(view, 118.0, 20.0);
  EXPECT_NEAR(monitor.heat(), 1.2 * std::exp(-1.0), 1e-3);
}

TEST(EncoderFrozen, SeesNothingAfterHalfOfTheWayWithoutACountAndNotBehindAnAxisThatFollows) {
  for (const bool counts : {false, true}) {
    EncoderFrozenMonitor monitor;
    AxisView view = quiet();
    const double from = view.reference_m;
    double went = 0.0;
    while (went < 0.0009) {
      monitor.step(view, 0.002, 30.0);
      EXPECT_FALSE(monitor.seesNothing(view.reference_m, 0.002)) << "after " << went;
      went += 5e-5;
      view.reference_m = from + went;
      view.moved_m = counts ? 5e-5 : 0.0;
    }
    for (int i = 0; i < 4; ++i) {
      monitor.step(view, 0.002, 30.0);
      view.reference_m += 5e-5;
    }
    EXPECT_EQ(monitor.seesNothing(view.reference_m, 0.002), !counts);
  }
}

TEST(Runaway, IsSeenWithAWrongSignAndNotWhenSomebodyPushes) {
  const auto run = [](double sign, double push_N, double seconds) {
    RunawayMonitor monitor;
    AxisView view = quiet();
    double position = 0.0, velocity = 0.0, integral = 0.0;
    return cyclesUntil(
        [&] {
          integral += 300000.0 * (0.0 - position) * kDt;
          const double wanted = 60000.0 * (0.0 - position) - 1500.0 * velocity + integral;
          view.force_N = std::min(270.0, std::max(-270.0, wanted));
          velocity += kDt * (sign * view.force_N + push_N - 100.0 * velocity) / 5.0;
          position += kDt * velocity;
          view.position_m = position;
          view.velocity = velocity;
          return monitor.step(view, 1e-3, 0.03, 0.5, 0.1, 0.005);
        },
        static_cast<int>(seconds / kDt));
  };
  EXPECT_GT(run(-1.0, 1.0, 1.0), 0) << "wrong sign";
  EXPECT_EQ(run(1.0, 0.0, 2.0), -1);
  EXPECT_EQ(run(1.0, 150.0, 2.0), -1) << "a patient who pushes with 150 N";
  EXPECT_EQ(run(1.0, -150.0, 2.0), -1);
  EXPECT_GT(run(0.0, -40.0, 2.0), 0) << "a drive without power: the load takes the axis along";
}

TEST(Runaway, IsNotAnAxisThatRunsALittleAheadOfAFastReference) {
  RunawayMonitor monitor;
  AxisView view = quiet();
  const auto ahead = [&] {
    view.reference_velocity = -0.075;
    view.velocity = -0.080;
    view.reference_m += view.reference_velocity * kDt;
    view.position_m = view.reference_m - 0.0012;
    view.force_N += 1.0;
    return monitor.step(view, 1e-3, 0.03, 0.5, 0.1, 0.005);
  };
  EXPECT_EQ(cyclesUntil(ahead, 200), -1) << "the distance does not grow";
}

/// 31 mm/s faster than its reference at 1 mm from it, after it had been dragged and broke loose.
TEST(Runaway, IsNotAnOvershootThatIsAboutToTurn) {
  const auto cyclesOf = [](double growth_m_per_s2, double push_N_per_cycle, int cycles) {
    RunawayMonitor monitor;
    AxisView view = quiet();
    view.force_limit_N = 500.0;
    view.reference_velocity = -0.0387;
    view.velocity = -0.0697;
    view.position_m = view.reference_m - 0.00095;  // beyond 1 mm after two cycles
    return cyclesUntil(
        [&] {
          view.reference_m += view.reference_velocity * kDt;
          view.velocity -= growth_m_per_s2 * kDt;
          view.position_m += view.velocity * kDt;
          view.force_N += push_N_per_cycle;
          return monitor.step(view, 1e-3, 0.03, 0.5, 0.1, 0.005);
        },
        cycles);
  };
  EXPECT_EQ(cyclesOf(0.004, 2.3, 20), -1) << "the speed stands: the loop is about to turn it";
  EXPECT_EQ(cyclesOf(0.2, 2.3, 20), -1);
  EXPECT_EQ(cyclesOf(2.5, 2.3, 20), 6) << "50 N too much on 20 kg: nothing holds it";
  EXPECT_EQ(cyclesOf(0.004, 2.3, 40), 23) << "50 N more have not made it slower";
}

TEST(Runaway, AtTheForceLimitNeedNotGrowFaster) {
  RunawayMonitor monitor;
  AxisView view = quiet();
  view.velocity = -0.05;
  view.force_N = view.force_limit_N;
  EXPECT_GT(cyclesUntil(
                [&] {
                  view.position_m += view.velocity * kDt;
                  return monitor.step(view, 1e-3, 0.03, 0.5, 0.1, 0.005);
                },
                100),
            0);
}

TEST(Runaway, IsNotAnAxisThatLagsBehindAFastReferenceOrOvershootsIt) {
  RunawayMonitor monitor;
  AxisView view = quiet();
  double position = 0.0, velocity = 0.0;
  const auto step = [&](double time) {  // soft gains, 0.15 m/s to and fro
    view.reference_m = 0.1 * std::cos(1.5 * time);
    view.reference_velocity = -0.15 * std::sin(1.5 * time);
    view.force_N = 20000.0 * (view.reference_m - position) + 200.0 * (view.reference_velocity - velocity);
    velocity += kDt * (view.force_N - 900.0 * velocity - 60.0) / 30.0;
    position += kDt * velocity;
    view.position_m = position;
    view.velocity = velocity;
    return monitor.step(view, 1e-3, 0.03, 0.5, 0.1, 0.005);
  };
  position = 0.1;
  double largest = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    ASSERT_FALSE(step(kDt * i)) << i;
    largest = std::max(largest, std::abs(view.reference_m - position));
  }
  EXPECT_GT(largest, 3e-3) << "it lagged enough to matter";
}

}  // namespace
}  // namespace knee_robot::control
