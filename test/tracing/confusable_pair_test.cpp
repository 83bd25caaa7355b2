#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

/// What is found where the command of actuator 4 runs ahead by so many rows of 1 ms, as before a drive with a delay.
TracedCase ranAheadBy(Eigen::Index rows) {
  return traceSimulated("", [rows](recording::Recording& r) {
    const Eigen::Index rest = r.force_N.rows() - rows;
    r.force_N.col(3).head(rest) = r.force_N.col(3).tail(rest).eval();
    r.command_V.resize(r.rows(), 0);
  });
}

TEST(Trace, ReportsAShortDelayAndADriveLagAsOnePair) {
  const TracedCase c = ranAheadBy(40);
  ASSERT_FALSE(c.result.effects.empty());
  const FoundEffect& first = c.result.effects[0];
  std::vector<std::string> names = first.indistinguishable_from;
  names.push_back(first.hypothesis.place.candidate->name());
  EXPECT_NE(std::find(names.begin(), names.end(), "delay"), names.end());
  EXPECT_NE(std::find(names.begin(), names.end(), "drive_lag"), names.end());
  EXPECT_EQ(first.hypothesis.place.actuator, 3);
}

TEST(Trace, NamesADelayThatIsLongEnoughToBeToldFromADriveLag) {
  const TracedCase c = ranAheadBy(80);
  ASSERT_FALSE(c.result.effects.empty());
  const FoundEffect& first = c.result.effects[0];
  EXPECT_EQ(first.hypothesis.place.candidate->name(), "delay");
  EXPECT_EQ(first.hypothesis.place.actuator, 3);
  EXPECT_LT(c.after_N[3], 0.5 * c.before_N[3]);
}

}  // namespace
}  // namespace knee_robot::tracing
