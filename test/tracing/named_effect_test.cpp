#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(Trace, NamesPreslidingAndRemovesItsErrorOnAnotherPath) {
  const TracedCase c = traceSimulated("  - {name: presliding, actuators: [2], stiffness_N_per_m: 2.0e+4}\n");
  ASSERT_EQ(c.result.effects.size(), 1u);
  EXPECT_EQ(c.result.effects[0].hypothesis.place.candidate->name(), "presliding");
  EXPECT_EQ(c.result.effects[0].hypothesis.place.actuator, 1);
  EXPECT_LE(c.result.effects[0].p, 0.005);
  EXPECT_LT(c.after_N[1], 0.6 * c.before_N[1]);
  for (const int other : {0, 2, 3})
    EXPECT_LT(c.after_N[other], 1.1 * c.before_N[other]);
}

}  // namespace
}  // namespace knee_robot::tracing
