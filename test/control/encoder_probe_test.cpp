// Test pulses: a healthy axis answers to them and goes nowhere, a dead encoder is found in a bounded time.
#include "knee_robot/control/encoder_probe.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::control {
namespace {

/// A mass with dry friction that sticks, 5 um a count, held by a soft loop.
struct StickingAxis {
  double friction_N = 60.0, load_N = 0.0, mass_kg = 15.0, position_m = 0.0, velocity = 0.0;
  bool dead = false;
  int dither = 0;
  void step(double force_N) {
    for (int k = 0; k < 10; ++k) {
      const double drive = force_N + load_N - 20000.0 * position_m - 800.0 * velocity;
      const bool sticks = velocity == 0.0 && std::abs(drive) <= friction_N;
      if (sticks) continue;
      const double direction = velocity != 0.0 ? velocity : drive;
      const double next = velocity + 1e-4 * (drive - std::copysign(friction_N, direction)) / mass_kg;
      velocity = velocity * next < 0.0 ? 0.0 : next;
      position_m += 1e-4 * velocity;
    }
  }
  std::int64_t counts() {
    dither = -dither;
    return dither + (dead ? 0 : std::lround(position_m / 5e-6));
  }
};

constexpr EncoderProbe::Settings kSettings{0.5, 2.0, 150.0};

/// Seconds until the probe says dead, at most `seconds`; negative: never.
double findDead(EncoderProbe& probe, StickingAxis& axis, double seconds, bool rests = true) {
  for (int k = 0; k < static_cast<int>(1000 * seconds); ++k) {
    if (!probe.step(rests, 0.001, axis.counts(), kSettings)) return 0.001 * k;
    axis.step(probe.force_N());
  }
  return -1.0;
}

TEST(EncoderProbe, LeavesAHealthyStickingAxisWhereItIs) {
  for (const double friction : {1.0, 15.0, 60.0, 110.0}) {
    for (const double load : {0.0, 0.5, 0.9}) {
      EncoderProbe probe;
      StickingAxis axis;
      axis.friction_N = friction;
      axis.load_N = load * friction;
      EXPECT_LT(findDead(probe, axis, 120.0), 0.0) << friction << " N";
      EXPECT_LT(std::abs(axis.position_m), axis.load_N / 20000.0 + 3e-4)
          << "no farther than where its loop carries the load";
    }
  }
}

TEST(EncoderProbe, FindsADeadEncoderAtRestWithinAPeriodAndHalfASecond) {
  for (const int dither : {0, 2}) {
    EncoderProbe probe;
    StickingAxis axis;
    axis.dither = dither;
    ASSERT_LT(findDead(probe, axis, 10.0), 0.0);
    axis.dead = true;
    const double after = findDead(probe, axis, 10.0);
    EXPECT_GT(after, 0.0);
    EXPECT_LT(after, 2.5);
  }
}

TEST(EncoderProbe, FindsADeadEncoderAroundATurningPointWithinHalfASecond) {
  EncoderProbe probe;
  StickingAxis axis;
  ASSERT_LT(findDead(probe, axis, 10.0, false), 0.0);
  axis.dead = true;
  const double after = findDead(probe, axis, 10.0, false);
  EXPECT_GT(after, 0.0);
  EXPECT_LT(after, 0.5);
}

TEST(EncoderProbe, SpeaksUpForABlockedAxisAndIsQuietWhenSwitchedOff) {
  EncoderProbe probe;
  StickingAxis axis;
  axis.friction_N = 1e6;
  EXPECT_GT(findDead(probe, axis, 10.0), 0.0);
  EncoderProbe off;
  for (int k = 0; k < 10000; ++k) {
    ASSERT_TRUE(off.step(true, 0.001, 0, {0.5, 0.0, 150.0}));
    ASSERT_EQ(off.force_N(), 0.0);
  }
}

}  // namespace
}  // namespace knee_robot::control
