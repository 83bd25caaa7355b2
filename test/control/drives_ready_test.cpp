// The drives' ready outputs on a digital input: a drive that loses its supply is known in the next cycle, not by what
// falls.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

double dropOf(std::uint8_t dead, bool ready_line, bool moving, std::string& fault) {
  Truth truth;
  truth.payload_kg = 15.0;
  truth.ready_line = ready_line;
  HoldingRobot robot(truth);
  if (moving) {
    robot.swing();
    robot.system->run(1.3);
  }
  const double height = robot.lowest = robot.plant.state().pose[1];
  robot.image.faults.drive_dead.store(dead);
  EXPECT_TRUE(robot.system->waitFor(MachineState::Faulted, 3.0));
  fault = robot.system->status().fault_name;
  return height - robot.lowest;
}

TEST(DrivesReady, ALostSupplyIsNamedAndCostsWhatTheBrakesTake) {
  for (const bool moving : {false, true}) {
    for (const std::uint8_t dead : {0x0F, 0x01, 0x08}) {
      std::string fault, without;
      const double drop_m = dropOf(dead, true, moving, fault), without_m = dropOf(dead, false, moving, without);
      EXPECT_EQ(fault, "drives_not_ready") << int{dead};
      EXPECT_NE(without, "drives_not_ready");
      EXPECT_LT(drop_m, 0.0025) << int{dead};
      EXPECT_LE(drop_m, without_m + 1e-4) << int{dead};
      std::printf("drives %x %s: %.2f mm, without the line %.2f mm (%s)\n", dead, moving ? "moving" : "at rest",
                  1e3 * drop_m, 1e3 * without_m, without.c_str());
    }
  }
}

TEST(DrivesReady, EnablingEndsBeforeTheBrakesOpenAndGoesThroughWhenTheSupplyIsBack) {
  Truth truth;
  truth.ready_line = true;
  HoldingRobot robot(truth);
  ASSERT_TRUE(robot.system->disable().ok);
  robot.image.faults.drive_dead.store(2);
  robot.lowest = robot.plant.state().pose[1];
  const double height = robot.lowest;
  const Answer refused = robot.system->enable();
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("not ready"), std::string::npos) << refused.sentence;
  EXPECT_NEAR(robot.lowest, height, 1e-4);
  EXPECT_TRUE(robot.system->waitFor(MachineState::Faulted, 3.0));
  robot.image.faults.drive_dead.store(0);
  EXPECT_TRUE(robot.system->resetFaults().ok);
  const Answer enabled = robot.system->enable();
  EXPECT_TRUE(enabled.ok) << enabled.sentence;
}

}  // namespace
}  // namespace knee_robot::control
