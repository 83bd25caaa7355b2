// The delay margin against a loop that is run with that delay.
#include "src/control/delay_margin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

namespace knee_robot::control {
namespace {

const PidGains kGains{60000.0, 300000.0, 1500.0, 100.0};

/// Whether an axis that begins 1 mm away from its reference has come to rest after 5 s, with a drive that acts
/// `delay_ms` late.
bool comesToRest(double mass, double viscous, int delay_ms) {
  Pid pid;
  pid.setGains(kGains);
  double position = 0.001, velocity = 0.0, largest = 0.0;
  pid.reset(position);
  std::deque<double> late(static_cast<std::size_t>(delay_ms), 0.0);
  for (int k = 0; k < 5000; ++k) {
    PidInput input;
    input.measured = position;
    input.dt = 0.001;
    late.push_back(pid.update(input, 1e6));
    const double force = late.front();
    late.pop_front();
    for (int j = 0; j < 10; ++j) {
      velocity += 1e-4 * (force - viscous * velocity) / mass;
      position += 1e-4 * velocity;
    }
    if (k >= 4000) largest = std::max(largest, std::abs(position));
  }
  return largest < 1e-4;
}

TEST(DelayMargin, IsWhereTheLoopBecomesUnstable) {
  for (const double mass : {10.0, 15.0, 30.0}) {
    const double margin_ms = 1e3 * delayMargin(kGains, mass, 150.0);
    EXPECT_GT(margin_ms, 3.0);
    EXPECT_TRUE(comesToRest(mass, 150.0, static_cast<int>(0.85 * margin_ms))) << margin_ms;
    EXPECT_FALSE(comesToRest(mass, 150.0, static_cast<int>(std::ceil(1.15 * margin_ms)))) << margin_ms;
  }
}

TEST(DelayMargin, GrowsWithSofterGains) {
  const PidGains soft{15000.0, 40000.0, 800.0, 100.0};
  EXPECT_GT(delayMargin(soft, 15.0, 150.0), 1.5 * delayMargin(kGains, 15.0, 150.0));
}

}  // namespace
}  // namespace knee_robot::control
