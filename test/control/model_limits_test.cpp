// A model whose numbers no machine has is not fed forward.
#include "src/control/model_limits.h"

#include <gtest/gtest.h>

#include "some_model.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::control {
namespace {

const mechanism::Robot& robotA() {
  static const mechanism::Robot robot = mechanism::configuredRobot("A");
  return robot;
}

/// Model of the robot's weights and friction, with one number changed.
std::string withParameter(std::size_t index, double value, double share = 1.0) {
  dynamics::Model model = fake::modelOf(robotA());
  model.parameters[index].value = value;
  return whatIsTooMuch(dynamics::PartedModel(model, robotA()), robotA(), share);
}

std::string withEffect(const std::string& name, int actuator, const std::vector<double>& shape, double coefficient) {
  dynamics::ModelEffect effect;
  effect.name = name;
  effect.actuators = {actuator};
  for (const double value : shape)
    effect.shape.push_back({"shape", value});
  effect.coefficients = {{"coefficient", coefficient}};
  return whatIsTooMuch(dynamics::PartedModel(fake::tracedModelOf(robotA(), {effect}), robotA()), robotA(), 1.0);
}

TEST(ModelLimits, AnOrdinaryModelAsksForLittleOfTheDrives) {
  for (const char* name : {"A", "B", "final"}) {
    const mechanism::Robot robot = mechanism::configuredRobot(name);
    EXPECT_EQ(whatIsTooMuch(dynamics::PartedModel(fake::modelOf(robot), robot), robot, 0.5), "") << name;
  }
}

TEST(ModelLimits, TellsTheAxisWhoseDriveCannotGiveWhatIsAsked) {
  const std::string friction = withParameter(dynamics::extended::kCoulomb + 1, 300.0);
  EXPECT_EQ(friction.rfind("asks axis 2 for 3", 0), 0u) << friction;
  EXPECT_NE(friction.find("N to move at 50 mm/s near home, its drive gives 270 N"), std::string::npos) << friction;
  const std::string offset = withParameter(dynamics::extended::kOffset + 3, -1e6);
  EXPECT_EQ(offset.rfind("asks axis 4 for -", 0), 0u) << offset;
  EXPECT_NE(offset.find("N at rest near home"), std::string::npos) << offset;
  EXPECT_NE(withParameter(dynamics::extended::kViscous, 1e6), "");
  EXPECT_NE(withParameter(dynamics::extended::kRotor + 2, 1e5), "");
}

TEST(ModelLimits, FrictionDoesNotPush) {
  const std::string said = withParameter(dynamics::extended::kCoulomb + 1, -75.0);
  EXPECT_EQ(said.rfind("gives axis 2 friction that pushes it on, with ", 0), 0u) << said;
  EXPECT_EQ(withParameter(dynamics::extended::kCoulomb + 1, 0.0), "");
}

TEST(ModelLimits, JudgesMoreStrictlyWhereSomebodyLiesOnIt) {
  EXPECT_EQ(withParameter(dynamics::extended::kCoulomb + 1, 180.0), "");
  EXPECT_NE(withParameter(dynamics::extended::kCoulomb + 1, 180.0, 0.5), "");
}

TEST(ModelLimits, LooksAtEffectsInMotionAndBesideHome) {
  EXPECT_EQ(withEffect("quadratic_drag", 1, {}, 900.0), "");
  EXPECT_NE(withEffect("quadratic_drag", 1, {}, 1e9), "");
  const double home_m = robotA().actuators[3].home_length_m;
  const std::string spring = withEffect("actuator_spring", 4, {home_m}, 4e5);
  EXPECT_NE(spring.find("asks axis 4 for"), std::string::npos) << spring << ": nothing at home, 8000 N beside it";
}

TEST(ModelLimits, NoNumberIsTooMuch) {
  EXPECT_NE(withParameter(dynamics::extended::kCoulomb + 1, std::nan("")), "");
}

}  // namespace
}  // namespace knee_robot::control
