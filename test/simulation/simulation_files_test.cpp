#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "test/refusal.h"
#include "test/simulation/plant_bench.h"

namespace knee_robot::simulation {
namespace {

std::string refusalOfFile(const std::string& text) {
  return refusalOf([&] { parseSimulationParameters(text, "test.yaml"); });
}

TEST(SimulationFiles, OfTheRepositoryStandStillOnTheirBrakes) {
  for (const char* name : {"A", "B", "final", "starting"}) {
    const mechanism::Robot robot = configuredRobot(name);
    const std::string path = std::string(KNEE_SOURCE_DIR) + "/config/simulation/" + name + ".yaml";
    RobotImage image;
    RobotSimulation simulation(robot, dynamics::loadRobotInertia(robot), loadSimulationParameters(path), image);
    const mechanism::Pose start = simulation.state().pose;
    for (int i = 0; i < 500; ++i)
      ASSERT_TRUE(simulation.step(1e-3)) << name;
    EXPECT_EQ(simulation.state().pose, start) << name;
  }
}

TEST(SimulationFiles, ReadOneAxisForAllOrFour) {
  const auto one = parseSimulationParameters("axes: [{viscous_N_s_per_m: 3, coulomb_N: 4}]", "test.yaml");
  for (const AxisParameters& axis : one.axes)
    EXPECT_EQ(axis.coulomb_N, 4.0);
  EXPECT_NE(refusalOfFile("axes: [{viscous_N_s_per_m: 3, coulomb_N: 4}, {viscous_N_s_per_m: 3, coulomb_N: 4}]")
                .find("has 2 entries"),
            std::string::npos);
}

TEST(SimulationFiles, RefuseUnknownKeysWrongNumbersAndSharedBits) {
  const std::string good = "axes: [{viscous_N_s_per_m: 3, coulomb_N: 4}]\n";
  EXPECT_EQ(refusalOfFile(good), "");
  EXPECT_NE(refusalOfFile(good + "gravity: 3\n").find("test.yaml:2: unknown key gravity"), std::string::npos)
      << refusalOfFile(good + "gravity: 3\n");
  EXPECT_NE(refusalOfFile("axes: [{viscous_N_s_per_m: -3, coulomb_N: 4}]").find("viscous_N_s_per_m"),
            std::string::npos);
  EXPECT_NE(refusalOfFile("axes: [{viscous_N_s_per_m: 3, coulomb_N: 4, hold_device: rope}]").find("hold_device"),
            std::string::npos);
  EXPECT_NE(refusalOfFile(good + "digital_outputs: {drive_enable: 1, hold_release: 1}\n").find("same bit"),
            std::string::npos);
}

}  // namespace
}  // namespace knee_robot::simulation
