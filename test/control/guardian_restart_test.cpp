// A guardian dies while it carries what a dead controller left to it, and another one is started.
#include "guarded_robot.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

/// Holding with 15 kg and late brakes, the controller dead for `dead_ms`: the drives carry; after 40 ms by less and less.
struct Carried : Guarded {
  explicit Carried(std::uint8_t late = 15, int dead_ms = 35) : Guarded(true) {
    image.faults.hold_late.store(late);
    pass(dead_ms);
    EXPECT_TRUE(guardian->report().acts.load());
    EXPECT_EQ(image.counter.outputs.load() & 3, 1) << "drives on";
  }
  void pass(int milliseconds) {
    for (int k = 0; k < milliseconds; ++k)
      step();
  }
};

TEST(AGuardianThatIsStartedAgain, GoesOnCarryingUntilBrakesThatEngageLateHold) {
  for (const bool controller_gone : {false, true}) {
    for (const auto& [dead_ms, without_ms] : {std::pair{35, 0}, {100, 0}, {35, 30}, {35, 1500}}) {
      Carried robot(15, dead_ms);
      const double height = robot.plant.state().pose[1];
      if (controller_gone) robot.link.controller_pid.store(2147483646);  // no such process
      robot.guardian.reset();
      robot.pass(without_ms);
      robot.startGuardian();
      EXPECT_EQ(robot.link.acts.load(), 1u) << "whoever waits for the hand-over goes on waiting";
      const AfterDeath after = robot.dies();
      EXPECT_TRUE(robot.guardian->report().went_on.load());
      EXPECT_LT(height - robot.plant.state().pose[1], 0.005) << without_ms << " ms without; once 51.5 mm";
      EXPECT_LT(after.on_s, 1.2);
      EXPECT_EQ(robot.link.acts.load(), 0u);
    }
  }
}

TEST(AGuardianThatIsStartedAgain, SwitchesOffWhatHasBeenCarriedForLongerThanAnyBrakeTakes) {
  Carried robot;
  robot.guardian.reset();
  robot.pass(2100);
  robot.startGuardian();
  robot.step();
  EXPECT_FALSE(robot.guardian->report().went_on.load());
  EXPECT_EQ(robot.image.counter.outputs.load(), 0);
}

TEST(AGuardianThatIsStartedAgain, SwitchesNothingOnWhereSomebodyHasBroughtTheOutputsDown) {
  Carried robot;
  robot.guardian.reset();
  robot.outputs->down();
  robot.link.acts.store(0);  // as GuardedBus::takeOver() and guardian --down-now leave it
  robot.startGuardian();
  for (int k = 0; k < 50; ++k) {
    robot.step();
    ASSERT_EQ(robot.image.counter.outputs.load(), 0);
  }
}

TEST(AGuardianThatIsStartedAgain, HandsOverWhatAControllerLeftThatHasJustDiedWithTheOtherOne) {
  for (const int without_ms : {0, 1500, 2100}) {
    Guarded robot(true);
    robot.image.faults.hold_late.store(15);
    robot.guardian.reset();
    robot.link.controller_pid.store(2147483646);  // no such process
    for (int k = 0; k < without_ms; ++k)
      robot.step();
    robot.startGuardian();
    robot.step();
    EXPECT_EQ(robot.guardian->report().acts.load(), without_ms < 2000);
    const AfterDeath after = robot.dies();
    if (without_ms > 2000) continue;
    EXPECT_LT(after.drop_m, 0.005) << without_ms << " ms without; once 63.7 mm";
    EXPECT_LT(after.on_s, 1.2);
  }
}

/// What guardian --down-now does beside a guardian that lives.
TEST(AControllerThatIsLockedOut, HasItsLoadHandedOverToTheBrakes) {
  Guarded robot(true);
  robot.image.faults.hold_late.store(15);
  robot.link.tripped.store(1);
  const AfterDeath after = robot.dies();
  EXPECT_LT(after.drop_m, 0.005) << "once 63.7 mm";
  EXPECT_LT(after.on_s, 1.2);
  EXPECT_EQ(robot.guardian->report().cause.load(), GuardianCause::LockedOut);
}

TEST(AGuardianThatIsStartedAgain, GoesOnWhereNoBrakeCanBeOrdered) {
  Carried robot(0);
  robot.image.counter.disconnected.store(simulation::kCardGone);
  robot.pass(100);
  const double height = robot.plant.state().pose[1];
  robot.guardian.reset();
  robot.pass(5000);
  robot.startGuardian();
  robot.pass(3000);
  EXPECT_LT(height - robot.plant.state().pose[1], 0.01) << "0 V would let it fall by 420 mm";
}

}  // namespace
}  // namespace knee_robot::control
