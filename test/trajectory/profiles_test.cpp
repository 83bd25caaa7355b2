#include "knee_robot/trajectory/profiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace knee_robot::trajectory {
namespace {

TEST(PointToPoint, TakesTheTimeWorkedByHandInEachOfItsFourShapes) {
  // 2 m at 1 m/s, 2 m/s^2, 4 m/s^3: jerk 0.5 s, ramp 1 s, so 2 m take 1 + 1 + 1 s.
  EXPECT_NEAR(PointToPoint(2.0, {1.0, 2.0, 4.0}).duration(), 3.0, 1e-12);
  // 1 m/s reached before 100 m/s^2: jerk 0.5 s, ramp 1 s at 4 m/s^3.
  EXPECT_NEAR(PointToPoint(2.0, {1.0, 100.0, 4.0}).duration(), 3.0, 1e-12);
  // Neither reached: d = 2 j t^3, t = 0.5 s.
  EXPECT_NEAR(PointToPoint(1.0, {100.0, 100.0, 4.0}).duration(), 2.0, 1e-12);
  // Acceleration reached (jerk 0.5 s), velocity not: ramp 1.5 s covers 2 m/s * 1.5 s / 2 = 1.5 m twice.
  EXPECT_NEAR(PointToPoint(3.0, {100.0, 2.0, 4.0}).duration(), 3.0, 1e-12);
}

TEST(PointToPoint, KeepsItsBoundsEndsAtRestAndIsTheIntegralOfItself) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-2.0, 1.0), way(-1.0, 1.0);
  for (int round = 0; round < 2000; ++round) {
    const ProfileLimits limits{std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random)),
                               std::pow(10.0, exponent(random))};
    const double distance = way(random);
    const PointToPoint profile(distance, limits);
    const double end = profile.duration();
    EXPECT_NEAR(profile.at(end * (1.0 - 1e-12)).position, distance, 1e-9 * std::max(1.0, limits.velocity));
    EXPECT_NEAR(profile.at(end).position, distance, 0.0);
    const double h = end * 1e-4;
    for (int k = 0; k <= 50; ++k) {
      const double time = end * k / 50.0;
      const ProfilePoint here = profile.at(time), before = profile.at(time - h), after = profile.at(time + h);
      ASSERT_LE(std::abs(here.velocity), limits.velocity * (1.0 + 1e-9));
      ASSERT_LE(std::abs(here.acceleration), limits.acceleration * (1.0 + 1e-9));
      ASSERT_LE(std::abs(after.acceleration - before.acceleration), 2.0 * h * limits.jerk * (1.0 + 1e-6));
      ASSERT_NEAR((after.position - before.position) / (2.0 * h), here.velocity, 2.0 * h * h * limits.jerk + 1e-9);
      ASSERT_NEAR((after.velocity - before.velocity) / (2.0 * h), here.acceleration, 2.0 * h * limits.jerk + 1e-9);
    }
  }
}

TEST(PointToPoint, StandsStillOverNoDistance) {
  const PointToPoint profile(0.0, {1.0, 1.0, 1.0});
  EXPECT_EQ(profile.duration(), 0.0);
  EXPECT_EQ(profile.at(0.5).position, 0.0);
}

}  // namespace
}  // namespace knee_robot::trajectory
