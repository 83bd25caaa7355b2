#include <gtest/gtest.h>

#include <cmath>

#include "src/control/monitor_encoder_leap.h"

namespace knee_robot::control {
namespace {

constexpr double kPeriod_s = 1e-3;

TEST(EncoderLeap, OfAnAxisAtRestIsSeenAndNoMotionThatForcesCanMakeIsOne) {
  const double count_m = 2e-5;
  EncoderLeapMonitor monitor;
  AxisView view;
  view.dt = kPeriod_s;
  for (const double moved_m : {0.0, 2e-5, -2e-5, 2e-4, 0.0}) {
    view.moved_m = moved_m;
    EXPECT_FALSE(monitor.step(view, count_m, 4.0, 200.0)) << moved_m;
  }
  for (int k = 0; k < 300; ++k)
    EXPECT_FALSE(monitor.step(view, count_m, 4.0, 200.0));
  view.moved_m = 9e-4;  // below the encoder jump's 2.2 mm
  EXPECT_TRUE(monitor.step(view, count_m, 4.0, 200.0));
  EncoderLeapMonitor pushed;
  double speed = 0.0;
  const auto accelerated = [&](double acceleration) {
    speed += acceleration * kPeriod_s;
    view.moved_m = speed * kPeriod_s;
    return pushed.step(view, count_m, 4.0, 200.0);
  };
  for (int k = 0; k < 10; ++k)
    EXPECT_FALSE(accelerated(100.0)) << "twice what the strongest push of the campaign does";
  view.dt = 0.03;
  view.moved_m = 0.009;
  EXPECT_FALSE(EncoderLeapMonitor{}.step(view, count_m, 4.0, 200.0)) << "a pause of the machine";
  view.moved_m = std::nan("");
  EXPECT_TRUE(monitor.step(view, count_m, 4.0, 200.0));
}

}  // namespace
}  // namespace knee_robot::control
