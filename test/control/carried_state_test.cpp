// What the operator reads while a guardian lets the drives carry.
#include "guarded_robot.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

/// Milliseconds in which the robot called itself off while its drives were on.
int wrongWithin(Guarded& robot, int milliseconds) {
  int wrong = 0;
  for (int k = 0; k < milliseconds; ++k) {
    robot.system->step();
    const ControlStatus said = robot.system->status();
    const bool off = said.state == MachineState::Faulted || said.state == MachineState::Disabled;
    const bool on = (robot.image.counter.outputs.load() & 1) != 0;
    if (off && on) ++wrong;
    if (robot.link.acts.load() != 0 && said.fault != Fault::None) {
      EXPECT_NE(said.fault_sentence.find("KEEP AWAY"), std::string::npos) << said.fault_sentence;
    }
  }
  return wrong;
}

TEST(AControllerThatWasSilent, SaysThatTheRobotIsOffWhenTheGuardianHasHandedOver) {
  for (const std::uint8_t late : {0, 15}) {
    Guarded robot(true);
    robot.image.faults.hold_late.store(late);
    robot.system->pause(0.1);
    robot.system->step();
    ASSERT_TRUE(robot.guardian->report().acts.load());
    EXPECT_LE(wrongWithin(robot, 2000), 1) << "once until the guardian had done, 0.3 to 2 s";
    const ControlStatus said = robot.system->status();
    EXPECT_EQ(said.state, MachineState::Faulted);
    EXPECT_EQ(said.fault_name, "guardian_acted") << said.fault_sentence;
    EXPECT_EQ(said.fault_sentence.find("KEEP AWAY"), std::string::npos) << said.fault_sentence;
    EXPECT_EQ(robot.image.counter.outputs.load() & 3, 0);
  }
}

}  // namespace
}  // namespace knee_robot::control
