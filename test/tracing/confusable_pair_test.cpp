#include "test/tracing/simulated_recordings.h"

namespace knee_robot {
namespace {

TEST(Trace, ReportsDelayAndDriveLagAsOnePair) {
  const TracedCase c = traceSimulated("  - {name: delay, actuators: [4], time_s: 0.01}\n");
  ASSERT_FALSE(c.result.effects.empty());
  const FoundEffect& first = c.result.effects[0];
  std::vector<std::string> names = first.indistinguishable_from;
  names.push_back(first.hypothesis.place.candidate->name());
  EXPECT_NE(std::find(names.begin(), names.end(), "delay"), names.end());
  EXPECT_NE(std::find(names.begin(), names.end(), "drive_lag"), names.end());
  EXPECT_EQ(first.hypothesis.place.actuator, 3);
}

}  // namespace
}  // namespace knee_robot
