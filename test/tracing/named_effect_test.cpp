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

TEST(Trace, NamesAScrewThatWhirlsNearItsCriticalSpeed) {
  const TracedCase c = traceSimulated(
      "  - {name: screw_whirl, actuators: [2], peak_N: 25, critical_m_per_s: 0.04, at_length_m: 0.75, width_m_per_s: "
      "0.01}\n");
  const auto& effects = c.result.effects;
  const auto whirl = std::find_if(effects.begin(), effects.end(), [](const FoundEffect& e) {
    return e.hypothesis.place.candidate->name() == "screw_whirl";
  });
  ASSERT_NE(whirl, effects.end());
  EXPECT_EQ(whirl->hypothesis.place.actuator, 1);
  const std::vector<double>& shape = whirl->hypothesis.shape;
  std::cout << "critical " << shape[0] << " m/s at " << shape[2] << " m, width " << shape[1] << " m/s, peak "
            << whirl->coefficients[0] << " N; error " << c.before_N[1] << " -> " << c.after_N[1] << " N\n";
  EXPECT_NEAR(shape[0] * std::pow(shape[2] / 0.75, 2), 0.04, 0.003);
  EXPECT_NEAR(whirl->coefficients[0], 25.0, 6.0) << "a peak of another shape";
  EXPECT_LT(c.after_N[1], 0.6 * c.before_N[1]);
}

}  // namespace
}  // namespace knee_robot::tracing
