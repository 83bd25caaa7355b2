// Emergency stop and hand switch: latched, and faulted from the start until somebody has looked.
#include <gtest/gtest.h>

#include "system_rig.h"

namespace knee_robot::control {
namespace {

using fake::Rig;

HardwareFile withInputs() {
  HardwareFile hardware = fake::hardware();
  hardware.emergency_stop_clear_bit = 0;
  hardware.hand_switch_clear_bit = 1;
  hardware.starts_faulted = true;
  return hardware;
}

TEST(Inputs, StartFaultedUntilResetThoughAllIsWell) {
  Rig rig(withInputs());
  const Answer started = rig.system.start();
  EXPECT_TRUE(started.ok);
  EXPECT_EQ(rig.system.state(), MachineState::Faulted);
  EXPECT_EQ(rig.system.status().fault_name, "not_reset");
  EXPECT_FALSE(rig.system.enable().ok);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  EXPECT_TRUE(rig.system.enable().ok);
}

TEST(Inputs, AreNotResetWhileOneOfThemIsPressed) {
  for (const std::uint8_t pressed : {0xe, 0xd}) {
    Rig rig(withInputs());
    rig.machine.inputs = pressed;
    ASSERT_TRUE(rig.system.start().ok);
    EXPECT_FALSE(rig.system.resetFaults().ok) << int{pressed};
    rig.machine.inputs = 0xf;
    rig.system.run(0.01);
    EXPECT_EQ(rig.system.state(), MachineState::Faulted) << "latched";
    EXPECT_TRUE(rig.system.resetFaults().ok);
  }
}

TEST(Inputs, HandSwitchBringsTheRobotToRestOnItsPathAndIsLatched) {
  Rig rig(withInputs());
  ASSERT_TRUE(rig.system.start().ok);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(2.0);
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.03, 2.0)).ok);
  ASSERT_TRUE(rig.system.play().ok);
  rig.system.run(1.0);
  rig.machine.inputs = 0xd;
  rig.system.run(0.005);
  rig.machine.inputs = 0xf;  // let go again at once
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "hand_switch");
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(1.0);
  EXPECT_EQ(rig.system.state(), MachineState::Holding) << "and not playing on";
}

TEST(Inputs, EmergencyStopIsNamedAlthoughTheDrivesFailAtTheSameMoment) {
  Rig rig(withInputs());
  ASSERT_TRUE(rig.system.start().ok);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(1.0);
  rig.machine.inputs = 0xe;
  for (auto& axis : rig.machine.axes)
    axis.drive_dead = true;
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "emergency_stop");
}

}  // namespace
}  // namespace knee_robot::control
