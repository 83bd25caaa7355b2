#include "knee_robot/control/set_point_follower.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/control/milliseconds.h"

namespace knee_robot::control {
namespace {

constexpr rt::Nanoseconds kPeriod = 10 * kMs;

/// Segment number n of a motion at constant speed along axis 1 from `start`.
SetPoint segment(int n, double start, double speed, std::uint32_t run = 1) {
  SetPoint point;
  point.sequence = static_cast<std::uint64_t>(n) + 1;
  point.run = run;
  point.phase = SyncPhase::Playing;
  point.start = n * kPeriod;
  point.duration = kPeriod;
  point.from_m[0] = start + speed * 0.01 * n;
  point.to_m[0] = start + speed * 0.01 * (n + 1);
  point.from_velocity[0] = point.to_velocity[0] = speed;
  return point;
}

SetPointFollower follower() {
  return {0, 0.5, 1.0, 0.3};
}

TEST(SetPointFollower, HoldsWhereItTookOverWhileSyncIsIdle) {
  SetPointFollower axis = follower();
  axis.takeOver(0.61, 0);
  SetPoint idle;
  idle.duration = kPeriod;
  EXPECT_EQ(axis.accept(idle, 0), Fault::None);
  EXPECT_EQ(axis.at(5 * kMs).position, 0.61);
  EXPECT_TRUE(axis.at(5 * kMs).at_rest);
}

TEST(SetPointFollower, RunsLinearlyBetweenPointsWithoutLookingAhead) {
  SetPointFollower axis = follower();
  axis.takeOver(0.6, 0);
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(axis.accept(segment(n, 0.6, 0.1), n * kPeriod), Fault::None);
    for (int ms = 0; ms < 10; ++ms) {
      const rt::Nanoseconds now = n * kPeriod + ms * kMs;
      EXPECT_NEAR(axis.at(now).position, 0.6 + 0.1 * rt::toSeconds(now), 1e-12);
      EXPECT_NEAR(axis.at(now).velocity, 0.1, 1e-12);
    }
  }
}

TEST(SetPointFollower, FadesOutTheDistanceToANewRunsFirstPoint) {
  SetPointFollower axis = follower();
  axis.takeOver(0.601, 0);
  axis.accept(segment(0, 0.6, 0.0), 0);
  double last = axis.at(0).position;
  EXPECT_NEAR(last, 0.601, 1e-12) << "no jump";
  for (int ms = 1; ms < 600; ++ms) {
    if (ms % 10 == 0) axis.accept(segment(ms / 10, 0.6, 0.0), ms * kMs);
    const double position = axis.at(ms * kMs).position;
    EXPECT_LE(std::abs(position - last), 4e-6);
    last = position;
  }
  EXPECT_NEAR(last, 0.6, 1e-12);
}

TEST(SetPointFollower, ComesToRestByItselfWhenTheNextPointIsMissing) {
  SetPointFollower axis = follower();
  axis.takeOver(0.6, 0);
  axis.accept(segment(0, 0.6, 0.1), 0);
  double last = axis.at(0).position, last_speed = 0.1;
  for (int ms = 1; ms <= 130; ++ms) {
    const double position = axis.at(ms * kMs).position;
    const double speed = (position - last) / 1e-3;
    EXPECT_LE(speed, last_speed + 1e-9);
    EXPECT_GE(speed, last_speed - 0.0011) << "no sudden stop";
    last = position;
    last_speed = speed;
  }
  EXPECT_TRUE(axis.at(130 * kMs).at_rest);
  EXPECT_FALSE(axis.at(50 * kMs).at_rest);
  EXPECT_FALSE(axis.isStale(30 * kMs, 3));
  EXPECT_TRUE(axis.isStale(31 * kMs, 3));
}

TEST(SetPointFollower, GoesOnWithoutAJumpAfterALatePoint) {
  SetPointFollower axis = follower();
  axis.takeOver(0.6, 0);
  axis.accept(segment(0, 0.6, 0.1), 0);
  const double before = axis.at(25 * kMs).position;
  SetPoint late = segment(1, 0.6, 0.1);
  late.start = 25 * kMs;
  EXPECT_EQ(axis.accept(late, 25 * kMs), Fault::None);
  EXPECT_NEAR(axis.at(25 * kMs).position, before, 1e-12);
}

TEST(SetPointFollower, ComesToTheEndOfWhatIsBlendedAlthoughEveryPointAtRestIsLate) {
  SetPointFollower axis = follower();
  axis.takeOver(0.601, 0);
  for (int n = 0; n <= 60; ++n) {
    axis.accept(segment(n, 0.6, 0.0), n * kPeriod + 4 * kMs);  // 4 ms after the end of the one before
    axis.at(n * kPeriod + 9 * kMs);
  }
  EXPECT_EQ(axis.at(60 * kPeriod + 5 * kMs).position, 0.6);
}

TEST(SetPointFollower, TakesAJumpForAFaultAndGoesOnAsBefore) {
  SetPointFollower axis = follower();
  axis.takeOver(0.6, 0);
  axis.accept(segment(0, 0.6, 0.1), 0);
  SetPoint jumped = segment(1, 0.602, 0.1);
  EXPECT_EQ(axis.accept(jumped, kPeriod), Fault::SetPointJump) << "does not continue the last one";
  EXPECT_EQ(axis.accept(segment(1, 0.6, 0.4), kPeriod), Fault::SetPointJump) << "faster than the axis may";
  SetPoint nan = segment(1, 0.6, 0.1);
  nan.to_m[0] = std::nan("");
  EXPECT_EQ(axis.accept(nan, kPeriod), Fault::NotANumber);
  EXPECT_TRUE(std::isfinite(axis.at(15 * kMs).position));
}

TEST(SetPointFollower, ReportsAMissingPointAndGoesOnWithoutAJumpSoThatAllFourCanStopTogether) {
  SetPointFollower axis = follower();
  axis.takeOver(0.6, 0);
  axis.accept(segment(0, 0.6, 0.1), 0);
  const double before = axis.at(2 * kPeriod - kMs).position;
  EXPECT_EQ(axis.accept(segment(2, 0.6, 0.1), 2 * kPeriod), Fault::SetPointStale);
  EXPECT_NEAR(axis.at(2 * kPeriod).position, before, 0.1 * 1e-3 + 1e-6);
  EXPECT_TRUE(loopStaysClosed(Fault::SetPointStale));
}

TEST(SetPointFollower, ToleratesAsManyMissingPointsAsItIsTold) {
  SetPointFollower axis(0, 0.5, 1.0, 0.3, 1);
  axis.takeOver(0.6, 0);
  axis.accept(segment(0, 0.6, 0.1), 0);
  EXPECT_EQ(axis.accept(segment(2, 0.6, 0.1), 2 * kPeriod), Fault::None);
  EXPECT_EQ(axis.accept(segment(5, 0.6, 0.1), 5 * kPeriod), Fault::SetPointStale);
}

}  // namespace
}  // namespace knee_robot::control
