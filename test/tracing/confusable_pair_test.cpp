#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

/// The command of actuator 4 runs ahead by this many rows of 1 ms, as before a drive with a delay.
void runAhead(recording::Recording& r) {
  constexpr Eigen::Index kRows = 80;
  const Eigen::Index rest = r.force_N.rows() - kRows;
  r.force_N.col(3).head(rest) = r.force_N.col(3).tail(rest).eval();
  r.command_V.resize(r.rows(), 0);
}

TEST(Trace, ReportsADelayAloneOrAsOnePairWithADriveLag) {
  const TracedCase c = traceSimulated("", runAhead);
  ASSERT_FALSE(c.result.effects.empty());
  const FoundEffect& first = c.result.effects[0];
  std::vector<std::string> names = first.indistinguishable_from;
  names.push_back(first.hypothesis.place.candidate->name());
  EXPECT_NE(std::find(names.begin(), names.end(), "delay"), names.end());
  for (const std::string& name : names)
    EXPECT_TRUE(name == "delay" || name == "drive_lag") << name;
  EXPECT_EQ(first.hypothesis.place.actuator, 3);
}

}  // namespace
}  // namespace knee_robot::tracing
