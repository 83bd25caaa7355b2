#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(Trace, SaysThatThePlatformsInertiaAbsorbsAPayloadAndHowHeavyItIs) {
  const TracedCase c = traceSimulated("  - {name: payload, mass_kg: 5, center_m: [0, 0, 0.1]}\n");
  EXPECT_TRUE(c.result.effects.empty());
  const std::vector<std::string>& absorbed = c.result.absorbed;
  EXPECT_TRUE(c.result.payload.stated) << c.result.payload.sentence;
  EXPECT_NEAR(c.result.payload.mass_kg, 5.0, 0.5) << c.result.payload.sentence;
  EXPECT_TRUE(std::any_of(absorbed.begin(), absorbed.end(),
                          [](const std::string& s) { return s.find("payload") != std::string::npos; }));
}

}  // namespace
}  // namespace knee_robot::tracing
