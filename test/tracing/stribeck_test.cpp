// How fast Stribeck friction falls off with the velocity: Tustin's curve and that of most models.
#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(Stribeck, FallsOffWithTheExponentThatTheDataPrefer) {
  const TracedCase c =
      traceSimulated("  - {name: stribeck, actuators: [2], excess_N: 30, velocity_m_per_s: 0.012, exponent: 1}\n");
  ASSERT_EQ(c.result.effects.size(), 1u);
  const FoundEffect& found = c.result.effects[0];
  EXPECT_EQ(found.hypothesis.place.candidate->name(), "stribeck");
  EXPECT_EQ(found.hypothesis.place.actuator, 1);
  std::cout << "velocity " << found.hypothesis.shape[0] << " m/s, exponent " << found.hypothesis.shape[1] << ", "
            << found.coefficients[0] << " N\n";
  EXPECT_LT(found.hypothesis.shape[1], 1.3);
  EXPECT_NEAR(found.hypothesis.shape[0], 0.012, 0.003);
  EXPECT_NEAR(found.coefficients[0], 30.0, 6.0);
}

}  // namespace
}  // namespace knee_robot::tracing
