#include "knee_robot/control/control_system.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/errors.h"
#include "system_rig.h"

namespace knee_robot::control {
namespace {

using fake::kHome;
using fake::Rig;

TEST(ControlSystem, StartsDisabledWithDrivesOffAndHoldDevicesEngaged) {
  Rig rig;
  EXPECT_FALSE(rig.system.enable().ok) << "not started";
  const Answer answer = rig.system.start();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  rig.system.run(0.1);
  EXPECT_EQ(rig.system.state(), MachineState::Disabled);
  for (const auto& event : rig.machine.events) {
    EXPECT_EQ(event.bits & 3u, 0u);
    EXPECT_EQ(event.volts, AxisValues{});
  }
}

TEST(ControlSystem, RefusesToStartWhenTheSelfTestFails) {
  Rig rig;
  rig.machine.passes_self_test = false;
  const Answer answer = rig.system.start();
  EXPECT_FALSE(answer.ok);
  EXPECT_EQ(answer.sentence, "the hardware's self test failed: the card does not answer");
}

TEST(ControlSystem, EnablesInTheOrderZeroVoltsDriveLoopsRelease) {
  Rig rig;
  ASSERT_TRUE(rig.system.start().ok);
  rig.machine.events.clear();
  ASSERT_TRUE(rig.system.enable().ok);
  double enabled = -1.0, released = -1.0;
  for (const auto& event : rig.machine.events) {
    const bool enable = event.bits & 1, release = event.bits & 2;
    if (enable && enabled < 0) enabled = event.time_s;
    if (release && released < 0) released = event.time_s;
    if (!enable) {
      EXPECT_EQ(event.volts, AxisValues{});
    }
    if (release) {
      EXPECT_TRUE(enable);
    }
  }
  EXPECT_GT(enabled, 0.0);
  EXPECT_GE(released - enabled, 0.02 + 0.05 - 0.002) << "drive delay and settling of the loops";
}

TEST(ControlSystem, CatchesThePlatformWithoutDroppingItWhenTheBrakesOpen) {
  Rig rig;
  rig.hold();
  EXPECT_GT(rig.lowest(), fake::kHome - 0.001)
      << "with the integral at its place the robot is back within a millimetre";
}

TEST(ControlSystem, PlaysAReferenceToItsEndAndHoldsThere) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.03, 2.0)).ok);
  ASSERT_TRUE(rig.system.play().ok);
  EXPECT_TRUE(rig.system.waitFor(MachineState::Playing, 0.5));
  EXPECT_FALSE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.01, 2.0)).ok) << "not while playing";
  double worst = 0.0;
  while (rig.system.state() == MachineState::Playing) {
    rig.system.step();
    const TrackingRow row = *rig.system.snapshot();
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      worst = std::max(worst, std::abs(row.reference_m[i] - row.position_m[i]));
  }
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_NEAR(rig.system.status().path_time_s, 2.0, 1e-9);
  EXPECT_LT(worst, 0.002);
  RecordProperty("worst_tracking_error_um", static_cast<int>(1e6 * worst));
  std::printf("largest tracking error %.3f mm\n", 1e3 * worst);
  rig.system.run(1.0);
  for (const auto& axis : rig.machine.axes)
    EXPECT_NEAR(axis.position, fake::kHome + 0.03, 2e-4);
}

TEST(ControlSystem, PlaysNoOtherReferenceThanTheOneThatWasExpected) {
  Rig rig;
  rig.hold();
  trajectory::Reference wanted = fake::smoothReference(fake::kHome, 0.03, 2.0), other = wanted;
  wanted.name = "wanted";
  other.name = "other";
  ASSERT_TRUE(rig.system.loadReference(wanted).ok);
  ASSERT_TRUE(rig.system.loadReference(other).ok) << "somebody else, in between";
  for (const Answer& answer : {rig.system.approach(0.01, {"wanted"}), rig.system.play({"wanted"})}) {
    EXPECT_FALSE(answer.ok);
    EXPECT_NE(answer.sentence.find("somebody else has loaded other in place of wanted"), std::string::npos)
        << answer.sentence;
  }
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_TRUE(rig.system.play({"other"}).ok);
}

TEST(ControlSystem, BeginsNothingThatWasAskedForBeforeSomebodyStoppedTheRobot) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.03, 2.0)).ok);
  const PathExpectation asked{"", rig.system.halts()};
  ASSERT_TRUE(rig.system.stop().ok) << "it holds: there is nothing to stop yet";
  for (const Answer& answer : {rig.system.approach(0.01, asked), rig.system.play(asked)}) {
    EXPECT_FALSE(answer.ok);
    EXPECT_NE(answer.sentence.find("somebody has stopped the robot"), std::string::npos) << answer.sentence;
  }
  rig.system.run(0.2);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_NEAR(rig.machine.axes[0].position, fake::kHome, 1e-3) << "nothing moved";
  EXPECT_TRUE(rig.system.play({"", rig.system.halts()}).ok) << "asked for after the stop";
  ASSERT_TRUE(rig.system.stopPath().ok);
  EXPECT_EQ(rig.system.halts(), *asked.halts + 1) << "who ends its own path ends nobody else's";
}

TEST(ControlSystem, BeginsNothingThatWasAskedForBeforeSomebodyPausedTheRobotOrLoadedAnotherContentOfTheSameName) {
  Rig rig;
  rig.hold();
  trajectory::Reference reference = fake::smoothReference(fake::kHome, 0.03, 2.0);
  reference.name = "lift";
  ASSERT_TRUE(rig.system.loadReference(reference).ok);
  const WishesSoFar asked = rig.system.wishesSoFar();
  rig.system.pause();  // refused: there is nothing to pause yet
  const Answer paused = rig.system.play({"lift", asked.halts, asked.pauses});
  EXPECT_NE(paused.sentence.find("somebody has paused the robot"), std::string::npos) << paused.sentence;
  ASSERT_TRUE(rig.system.loadReference(reference).ok) << "by somebody else";
  const Answer other = rig.system.play({"lift", asked.halts, std::nullopt, asked.loaded});
  EXPECT_NE(other.sentence.find("somebody else has loaded lift since"), std::string::npos) << other.sentence;
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_TRUE(rig.system.play({"lift", asked.halts, std::nullopt, rig.system.wishesSoFar().loaded}).ok);
}

TEST(ControlSystem, RefusesToPlayWhereTheRobotDoesNotStandAndApproachesSlowlyOnRequest) {
  Rig rig;
  rig.hold();
  EXPECT_EQ(rig.system.play().sentence, "no reference is loaded; load one first");
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome + 0.02, 0.01, 1.0)).ok);
  const Answer refused = rig.system.play();
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("mm from the reference's first point"), std::string::npos) << refused.sentence;
  rig.system.run(0.2);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_NEAR(rig.machine.axes[0].position, fake::kHome, 1e-3) << "nothing moved";
  const Answer approach = rig.system.approach(0.01);
  ASSERT_TRUE(approach.ok) << approach.sentence;
  double fastest = 0.0;
  while (rig.system.state() == MachineState::Playing) {
    rig.system.step();
    fastest = std::max(fastest, std::abs(rig.machine.axes[3].velocity));
  }
  EXPECT_LT(fastest, 0.015);
  rig.system.run(0.5);
  const Answer played = rig.system.play();
  EXPECT_TRUE(played.ok) << played.sentence;
  EXPECT_TRUE(rig.system.waitFor(MachineState::Holding, 3.0));
  EXPECT_FALSE(rig.system.play().ok) << "a second run from the first point while the robot stands at the last";
}

TEST(ControlSystem, SaysThatItStandsAtTheStartExactlyWherePlayingWouldBegin) {
  for (const double away_mm : {0.5, 1.8, 2.2, 3.9}) {
    Rig rig;
    rig.hold();
    EXPECT_FALSE(rig.system.status().at_start) << "without a reference there is no start";
    ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome + 1e-3 * away_mm, 0.01, 1.0)).ok);
    rig.system.run(0.05);
    const bool said = rig.system.status().at_start;
    EXPECT_EQ(said, away_mm < 2.0) << away_mm << " mm";
    EXPECT_EQ(rig.system.play().ok, said) << away_mm << " mm";
  }
}

TEST(ControlSystem, StopsAlongThePathWithoutAJumpAndHolds) {
  Rig rig;
  rig.play();
  ASSERT_TRUE(rig.system.stop().ok);
  AxisValues last = rig.system.snapshot()->reference_m;
  double last_speed = -1.0, hardest = 0.0;
  while (rig.system.state() != MachineState::Holding) {
    rig.system.step();
    const AxisValues reference = rig.system.snapshot()->reference_m;
    const double speed = (reference[0] - last[0]) / 1e-3;
    EXPECT_EQ(reference[0], reference[1]) << "all four stay on the path";
    if (last_speed >= 0.0) hardest = std::max(hardest, std::abs(speed - last_speed));
    last = reference;
    last_speed = speed;
  }
  EXPECT_LT(hardest, 0.002) << "m/s from one millisecond to the next";
  rig.system.run(0.5);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_LT(rig.system.status().path_time_s, 1.3);
  EXPECT_NEAR(rig.machine.axes[2].position, last[2], 3e-4);
}

TEST(ControlSystem, RefusesABadReferenceAsAWhole) {
  Rig rig;
  rig.hold();
  trajectory::Reference jump = fake::smoothReference(fake::kHome, 0.01, 1.0);
  jump.points(50, 2) += 0.02;
  const Answer answer = rig.system.loadReference(jump);
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("smooth.txt:"), std::string::npos) << answer.sentence;
  EXPECT_EQ(rig.system.status().reference, "");
  EXPECT_FALSE(rig.system.play().ok);
}

TEST(ControlSystem, LoadsWhatItHasCheckedItselfAndNothingThatAnotherOneHas) {
  Rig rig, other;
  rig.hold();
  trajectory::Reference jump = fake::smoothReference(fake::kHome, 0.01, 1.0);
  PlayableReference playable = rig.system.check(jump);
  jump.points(50, 2) += 0.02;
  EXPECT_THROW(rig.system.check(jump), InputError);
  playable.rename("by another name");
  EXPECT_FALSE(other.system.loadReference(playable).ok) << "its robot may have other limits";
  EXPECT_EQ(other.system.status().reference, "");
  const Answer loaded = rig.system.loadReference(playable);
  EXPECT_TRUE(loaded.ok) << loaded.sentence;
  EXPECT_EQ(rig.system.status().reference, "by another name");
}

TEST(ControlSystem, DoesNotResumeAfterItWasDisabled) {
  Rig rig;
  rig.play();
  ASSERT_TRUE(rig.system.disable().ok);
  EXPECT_EQ(rig.system.state(), MachineState::Disabled);
  const double stood = rig.machine.axes[0].position;
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(1.0);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  EXPECT_NEAR(rig.machine.axes[0].position, stood, 1e-3);
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
}

TEST(ControlSystem, AnswersEveryRequestInEveryStateAsTheTableSays) {
  Rig rig;
  ASSERT_TRUE(rig.system.start().ok);
  EXPECT_FALSE(rig.system.play().ok);
  EXPECT_TRUE(rig.system.stop().ok);
  EXPECT_TRUE(rig.system.disable().ok);
  EXPECT_TRUE(rig.system.resetFaults().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  EXPECT_FALSE(rig.system.enable().ok) << "already";
  EXPECT_FALSE(rig.system.resetFaults().ok);
  ASSERT_TRUE(rig.system.emergencyStop().ok);
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "emergency_stop");
  EXPECT_FALSE(rig.system.enable().ok);
  EXPECT_FALSE(rig.system.play().ok);
  EXPECT_TRUE(rig.system.resetFaults().ok);
  EXPECT_EQ(rig.system.state(), MachineState::Disabled);
}

TEST(ControlSystem, LatchesTheEmergencyStopsInputUntilItIsReleasedAndReset) {
  HardwareFile hardware = fake::hardware();
  hardware.emergency_stop_clear_bit = 1;
  Rig rig(hardware);
  rig.play();
  rig.machine.inputs = 0;
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_FALSE(rig.system.resetFaults().ok) << "still pressed";
  rig.machine.inputs = 0xf;
  rig.system.run(0.01);
  EXPECT_EQ(rig.system.state(), MachineState::Faulted) << "latched";
  EXPECT_TRUE(rig.system.resetFaults().ok);
}

TEST(ControlSystem, StartsFaultedWhileTheEmergencyStopIsPressed) {
  HardwareFile hardware = fake::hardware();
  hardware.emergency_stop_clear_bit = 1;
  Rig rig(hardware);
  rig.machine.inputs = 0;
  EXPECT_TRUE(rig.system.start().ok);
  EXPECT_EQ(rig.system.state(), MachineState::Faulted);
  EXPECT_FALSE(rig.system.enable().ok);
}

TEST(ControlSystem, UnwrapsCountersAndKeepsSignsApart) {
  Rig rig;
  rig.play();
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    EXPECT_NEAR(rig.system.snapshot()->position_m[i], rig.machine.axes[i].position, 1e-3) << i;
  }
  ASSERT_TRUE(rig.system.waitFor(MachineState::Holding, 3.0));
}

}  // namespace
}  // namespace knee_robot::control
