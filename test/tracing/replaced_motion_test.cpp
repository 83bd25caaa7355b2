#include <algorithm>

#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(Trace, FindsAFlexibleCouplingByTheMotionOfTheScrew) {
  const TracedCase c = traceSimulated("  - {name: flexible_coupling, actuators: [2], stiffness_N_per_m: 4.0e+4}\n");
  ASSERT_FALSE(c.result.effects.empty());
  const FoundEffect& first = c.result.effects[0];
  std::vector<std::string> names = first.indistinguishable_from;
  names.push_back(first.hypothesis.place.candidate->name());
  EXPECT_NE(std::find(names.begin(), names.end(), "flexible_coupling"), names.end());
  EXPECT_EQ(first.hypothesis.place.actuator, 1);
  EXPECT_LT(c.after_N[1], 0.8 * c.before_N[1]);
}

}  // namespace
}  // namespace knee_robot::tracing
