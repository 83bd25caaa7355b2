// A holding brake that does not hold, behind every reason to stop: the drives carry on, and whoever ends the controller
// is told.
#include "holding_robot.h"
#include "knee_robot/hardware/guarded_bus.h"

namespace knee_robot::control {
namespace {

using namespace holding;

constexpr std::uint8_t kAll = 0x0F;

/// The platform stays within half a millimetre of where it stands and is not let go.
void expectCarried(HoldingRobot& robot, double height) {
  EXPECT_LT(height - robot.lowest, 0.002);
  EXPECT_EQ(robot.image.status.drives_enabled.load(), kAll);
  EXPECT_TRUE(robot.system->drivesCarry());
  const Answer refused = robot.system->shutdown();
  EXPECT_FALSE(refused.ok) << refused.sentence;
  EXPECT_NE(refused.sentence.find("brake"), std::string::npos) << refused.sentence;
  EXPECT_LT(height - robot.lowest, 0.004) << "it tried to hand over the load once more, and took it back";
}

TEST(SlippingBrake, IsSaidAndCarriedBehindAnotherFaultToo) {
  for (const bool emergency : {true, false}) {
    HoldingRobot robot;
    const double height = robot.lowest = robot.plant.state().pose[1];
    robot.image.faults.hold_open.store(kAll);
    emergency ? robot.system->emergencyStop() : robot.system->disable();
    robot.system->run(3.0);
    EXPECT_EQ(robot.system->state(), MachineState::SafeStopping);
    EXPECT_EQ(robot.system->status().fault_name, "hold_device_slips") << "somebody has to act on this, first of all";
    expectCarried(robot, height);
  }
}

TEST(SlippingBrake, IsCarriedWithoutASupervisorToo) {
  HoldingRobot robot;
  const double height = robot.lowest = robot.plant.state().pose[1];
  robot.image.faults.hold_open.store(kAll);
  robot.system->deployment().component("Supervisor")->stop();
  robot.system->run(3.0);
  expectCarried(robot, height);
  // Somebody supports the platform, or mends the brake; nobody is left who could be told.
  robot.image.faults.hold_open.store(0);
  robot.system->run(25.0);
  EXPECT_FALSE(robot.system->drivesCarry());
  EXPECT_TRUE(robot.system->outputsAreOff());
  EXPECT_TRUE(robot.system->shutdown().ok);
}

TEST(SlippingBrake, KeepsTheOtherLoopsAndALoadEstimateWhereOneLoopFailsMeanwhile) {
  HoldingRobot robot;
  const double height = robot.lowest = robot.plant.state().pose[1];
  robot.image.faults.hold_open.store(kAll);
  robot.system->disable();
  robot.system->run(3.0);
  ASSERT_TRUE(robot.system->drivesCarry());
  robot.image.faults.encoder[0].store(static_cast<std::uint8_t>(simulation::EncoderFault::Jump));
  robot.system->run(3.0);
  EXPECT_TRUE(robot.system->drivesCarry());
  EXPECT_LT(height - robot.lowest, 0.005);
  EXPECT_FALSE(robot.system->shutdown().ok) << "asked by nobody who has put a support under it";
  robot.system->run(2.0);
  EXPECT_TRUE(robot.system->drivesCarry());
  EXPECT_LT(height - robot.lowest, 0.01);
}

TEST(SlippingBrake, DoesNotLetDrivesThatLostTheirSupplyPushAgainWhenItComesBack) {
  Truth truth;
  truth.ready_line = true;
  HoldingRobot robot(truth);
  robot.image.faults.hold_open.store(kAll);
  robot.system->disable();
  robot.system->run(3.0);
  ASSERT_TRUE(robot.system->drivesCarry());
  robot.image.faults.drive_dead.store(kAll);
  robot.system->run(0.5);
  robot.image.faults.drive_dead.store(0);
  robot.system->run(0.5);
  EXPECT_EQ(robot.image.status.drives_enabled.load(), 0);
  EXPECT_EQ(robot.system->state(), MachineState::Faulted);
}

TEST(SlippingBrake, KeepsTheEmergencyStopsRuleForAReset) {
  HoldingRobot robot;
  robot.image.faults.hold_open.store(kAll);
  robot.system->disable();
  robot.system->run(3.0);
  ASSERT_TRUE(robot.system->drivesCarry());
  robot.image.surroundings.emergency_stop_pressed.store(1);
  robot.system->run(1.0);
  ASSERT_EQ(robot.system->state(), MachineState::Faulted);
  EXPECT_EQ(robot.system->status().fault_name, "hold_device_slips");
  EXPECT_FALSE(robot.system->resetFaults().ok) << "the button is pressed";
  robot.image.surroundings.emergency_stop_pressed.store(0);
  robot.system->run(0.1);
  EXPECT_TRUE(robot.system->resetFaults().ok);
}

TEST(EndingController, RefusesToMoveAndGoesOnBeingStopped) {
  HoldingRobot robot;
  ASSERT_TRUE(robot.system->disable().ok);
  robot.system->refuseToMove();
  const Answer enabled = robot.system->enable();
  EXPECT_FALSE(enabled.ok);
  EXPECT_NE(enabled.sentence.find("ending"), std::string::npos) << enabled.sentence;
  EXPECT_TRUE(robot.system->disable().ok);
}

TEST(WhoStops, WinsOverARequestThatWasMadeBefore) {
  HoldingRobot robot;
  ASSERT_TRUE(robot.system->disable().ok);
  const std::uint64_t asked = robot.system->halts();
  robot.system->disable();
  const Answer enabled = robot.system->enable(asked);
  EXPECT_FALSE(enabled.ok);
  EXPECT_NE(enabled.sentence.find("stopped the robot"), std::string::npos) << enabled.sentence;
  EXPECT_EQ(robot.system->state(), MachineState::Disabled);
  EXPECT_TRUE(robot.system->enable().ok);
}

}  // namespace
}  // namespace knee_robot::control
