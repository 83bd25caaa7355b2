#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

// 20 kN/m under some 20 N of dry friction: a way of about a millimetre. Before the law near rest was chosen by the
// data, this was an effect of its own; now the baseline knows it, and nothing is left to name.
TEST(Trace, KnowsPreslidingAsTheLawNearRestOfItsActuator) {
  const TracedCase plain = traceSimulated("");
  const TracedCase c = traceSimulated("  - {name: presliding, actuators: [2], stiffness_N_per_m: 2.0e+4}\n");
  const auto width = [](const TracedCase& t, std::size_t i) { return longestWidth(t.result.base.friction_laws[i]); };
  std::cout << "law of actuator 2: " << dynamics::describe(c.result.base.friction_laws[1]) << "; without presliding "
            << dynamics::describe(plain.result.base.friction_laws[1]) << "; error " << c.after_N[1] << " N, without "
            << plain.after_N[1] << " N\n";
  EXPECT_GT(width(c, 1), 3e-4);
  EXPECT_GT(width(c, 1), 3.0 * width(plain, 1));
  EXPECT_LT(c.after_N[1], 1.5 * plain.after_N[1]);
  for (const FoundEffect& e : c.result.effects)
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "presliding") << "nothing else is there";
}

}  // namespace
}  // namespace knee_robot::tracing
