// Laws of friction near rest, step by step.
#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/dynamics/friction_law.h"

namespace knee_robot::dynamics {
namespace {

TEST(FrictionState, OfAStopIsTheSignWhileMovingAndKeepsItAtRest) {
  const FrictionLaw law = stopLaw(1e-4);
  FrictionState state;
  EXPECT_DOUBLE_EQ(state.step(law, 0.0, 0.01), 0.0);
  EXPECT_DOUBLE_EQ(state.step(law, 3e-5, 0.01), 0.3);
  EXPECT_DOUBLE_EQ(state.step(law, 1e-2, 0.01), 1.0);
  EXPECT_DOUBLE_EQ(state.step(law, 0.0, 0.01), 1.0);
  EXPECT_DOUBLE_EQ(state.step(law, -5e-5, 0.01), 0.5);
  EXPECT_DOUBLE_EQ(state.step(law, -1.0, 0.01), -1.0);
}

TEST(FrictionState, OfAStopBehindAClearanceIsNothingUntilItIsCrossed) {
  FrictionLaw law = stopLaw(1e-4);
  law.elements[0].gap_m = 4e-5;
  FrictionState state;
  EXPECT_DOUBLE_EQ(state.step(law, 1.5e-5, 0.01), 0.0);  // half of the clearance is 20 um
  EXPECT_DOUBLE_EQ(state.step(law, 3.5e-5, 0.01), 0.3);  // 30 um beyond it
  EXPECT_DOUBLE_EQ(state.step(law, 1e-2, 0.01), 1.0);
  EXPECT_NEAR(state.step(law, -1e-4, 0.01), 0.0, 1e-12);  // back at its edge
  EXPECT_NEAR(state.step(law, -4e-5, 0.01), 0.0, 1e-12);  // and at the other
  EXPECT_NEAR(state.step(law, -5e-5, 0.01), -0.5, 1e-12);
  EXPECT_DOUBLE_EQ(state.step(law, 0.0, 100.0), -0.5);
  EXPECT_EQ(describe(law), "stop 100 um, gap 40 um");
}

TEST(FrictionState, OfAStopThatRelaxesLetsGoInItsTime) {
  FrictionLaw law = stopLaw(1e-4);
  law.elements[0].relaxation_s = 2.0;
  FrictionState state;
  EXPECT_DOUBLE_EQ(state.step(law, 1e-2, 0.01), 1.0);
  EXPECT_NEAR(state.step(law, 0.0, 2.0), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(state.step(law, 0.0, 1.0), std::exp(-1.5), 1e-12);
  EXPECT_EQ(describe(law), "stop 100 um, relaxes in 2 s");
}

TEST(FrictionState, OfASmoothLawThatLagsFollowsTheVelocityInItsTime) {
  FrictionLaw law = smoothLaw(1e-3);
  law.elements[0].lag_s = 0.02;
  FrictionState state;
  for (int k = 1; k <= 50; ++k)
    EXPECT_NEAR(state.step(law, 2e-6, 1e-3), std::tanh(2.0 * (1.0 - std::exp(-k / 20.0))), 1e-12);
  EXPECT_NEAR(state.step(law, 0.0, 0.04), std::tanh(2.0 * (1.0 - std::exp(-2.5)) * std::exp(-2.0)), 1e-12);
  EXPECT_EQ(describe(law), "tanh(v / 1 mm/s), lags by 20 ms");
  EXPECT_EQ(nameOf(law), "tanh of lagging velocity");
}

TEST(FrictionState, OfBristlesWithAnExponentSolvesDahlsEquation) {
  for (const double exponent : {0.5, 1.0, 1.6, 3.0}) {
    FrictionLaw law = bristleLaw(1e-4);
    law.elements[0].exponent = exponent;
    FrictionState state;
    double z = 0.0;
    for (const double displacement : {8e-5, 4e-4, 0.0, -3e-5, -2e-3, 5e-6}) {
      constexpr int kSteps = 200000;
      const double sign = displacement < 0.0 ? -1.0 : 1.0;
      for (int k = 0; k < kSteps; ++k)
        z += std::pow(std::max(0.0, 1.0 - sign * z), exponent) * displacement / kSteps / 1e-4;
      EXPECT_NEAR(state.step(law, displacement, 0.01), z, 1e-4) << exponent << " after " << displacement;
    }
  }
}

TEST(FrictionState, OfAPowerOfTheVelocityLetsCreepingAxesPass) {
  FrictionLaw law = smoothLaw(1e-3);
  law.elements[0].exponent = 3.0;
  FrictionState state;
  for (const double speed : {0.0, 2e-4, 9e-4, 2e-3}) {
    const double z = std::tanh(std::pow(speed / 1e-3, 3.0));
    EXPECT_NEAR(state.step(law, 0.01 * speed, 0.01), z, 1e-12) << speed;
    EXPECT_NEAR(state.step(law, -0.01 * speed, 0.01), -z, 1e-12) << speed;
  }
  EXPECT_EQ(describe(law), "tanh((v / 1 mm/s)^3)");
}

TEST(FrictionState, OfARampIsProportionalToTheVelocityUpToItsSpeed) {
  FrictionLaw law = smoothLaw(2e-3);
  law.elements[0].smooth = SmoothShape::Ramp;
  FrictionState state;
  EXPECT_NEAR(state.step(law, 0.01 * 5e-4, 0.01), 0.25, 1e-12);
  EXPECT_NEAR(state.step(law, -0.01 * 1e-3, 0.01), -0.5, 1e-12);
  EXPECT_EQ(state.step(law, 0.01 * 3e-3, 0.01), 1.0);
  EXPECT_EQ(describe(law), "ramp up to 2 mm/s");
  EXPECT_EQ(nameOf(law), "ramp of velocity");
}

TEST(FrictionState, OfASmoothLawRisesAsItsShapeSaysAndIsWrittenAsThat) {
  const double speed = 8e-4;
  const struct {
    SmoothShape shape;
    double at_half, at_ten;
    const char *name, *text;
  } cases[] = {
      {SmoothShape::Rational, 1.0 / 3.0, 10.0 / 11.0, "rational law of velocity", "v / (|v| + 0.8 mm/s)"},
      {SmoothShape::Root, 0.4472135955, 0.9950371902, "root law of velocity", "v / sqrt(v^2 + (0.8 mm/s)^2)"},
      {SmoothShape::Arctangent, 0.2951672353, 0.9365489652, "arctangent of velocity", "2/pi atan(v / 0.8 mm/s)"},
  };
  for (const auto& c : cases) {
    const FrictionLaw law = smoothLaw(speed, c.shape);
    FrictionState state;
    EXPECT_NEAR(state.step(law, 0.01 * 0.5 * speed, 0.01), c.at_half, 1e-9) << c.name;
    EXPECT_NEAR(state.step(law, -0.01 * 10.0 * speed, 0.01), -c.at_ten, 1e-9) << c.name;
    EXPECT_EQ(nameOf(law), c.name);
    EXPECT_EQ(describe(law), c.text);
  }
}

}  // namespace
}  // namespace knee_robot::dynamics
