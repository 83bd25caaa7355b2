#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

// A coupling of 40 kN/m before a screw with dry friction gives way by some 0.4 mm at every reversal. The law of
// friction near rest takes that up (a stop of 362 um); what is left has been too little to name since that law is
// chosen by the data.
TEST(Trace, TakesTheGiveOfAFlexibleCouplingUpInTheLawNearRestAndNamesNothingElse) {
  const TracedCase c = traceSimulated("  - {name: flexible_coupling, actuators: [2], stiffness_N_per_m: 4.0e+4}\n");
  const dynamics::FrictionLaw& law = c.result.base.friction_laws[1];
  std::cout << "law of actuator 2: " << dynamics::describe(law) << "; error before " << c.before_N[1] << " N, after "
            << c.after_N[1] << " N\n";
  EXPECT_GT(longestWidth(law), 1e-4);
  EXPECT_LT(c.after_N[1], 1.05 * c.before_N[1]);
  EXPECT_LT(c.after_N[1], 2.0) << "2.9 N with a law of one short stop";
  for (const FoundEffect& e : c.result.effects)
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "flexible_coupling") << "nothing else is there";
}

}  // namespace
}  // namespace knee_robot::tracing
