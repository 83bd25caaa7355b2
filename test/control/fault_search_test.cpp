#include "src/control/fault_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "supervisor_view_of.h"

namespace knee_robot::control {
namespace {

struct Component : rt::TaskContext {
  Component() : rt::TaskContext("Component") {}
};

HardwareFile withStops() {
  HardwareFile hardware = fake::hardware();
  hardware.emergency_stop_clear_bit = 0;
  hardware.hand_switch_clear_bit = 1;
  hardware.drives_ready_bit = 2;
  return hardware;
}

class FaultSearching : public ::testing::Test {
 protected:
  FaultSearching() {
    components.add(component);
    EXPECT_TRUE(component.configure() && component.start());
    conditions.range_margin_m = 0.005;
    conditions.homed = true;
  }
  Fault found() const { return search.find(view, conditions).fault; }

  const mechanism::Robot robot = fake::robot();
  const SafetyInputs inputs{withStops()};
  Component component;
  ComponentWatch components;
  const FaultSearch search{robot, inputs, components};
  SupervisorView view = fake::wellView(DriveLevel::Released);
  FaultSearch::Conditions conditions;
};

TEST_F(FaultSearching, FindsNothingOnAMachineThatIsWell) {
  EXPECT_EQ(found(), Fault::None);
}

TEST_F(FaultSearching, NamesTheCauseBeforeWhatFollowsFromIt) {
  // From the last in the order to the first: each one hides all that were there before.
  const std::pair<Fault, std::function<void()>> order[] = {
      {Fault::Overrun, [&] { conditions.overrun = true; }},
      {Fault::NotANumber, [&] { view.written.fault = Fault::NotANumber; }},
      {Fault::FollowingError, [&] { view.commands[1].fault = Fault::FollowingError; }},
      {Fault::Runaway, [&] { view.verdict.fault[0] = Fault::Runaway; }},
      {Fault::EncoderFrozen, [&] { view.verdict.fault[3] = Fault::EncoderFrozen; }},
      {Fault::MonitorsStale, [&] { view.unmonitored = conditions.stale_cycles; }},
      {Fault::PositionOutOfRange, [&] { view.measured.position_m[2] = 1.1; }},
      {Fault::OutputLost, [&] { view.written.status = hardware::IoStatus::Disconnected; }},
      {Fault::MeasurementLost, [&] { view.unreadable = conditions.stale_cycles; }},
      {Fault::ComponentStopped, [&] { component.stop(); }},
      {Fault::DriveLost, [&] { view.measured.bus_failure.fault = hardware::BusFault::DriveLost; }},
      {Fault::DrivesNotReady, [&] { view.measured.digital_inputs = 3; }},
      {Fault::HandSwitch, [&] { view.measured.digital_inputs = 1; }},
      {Fault::EmergencyStop, [&] { view.measured.digital_inputs = 0; }},
      {Fault::GuardianActed, [&] { view.measured.fenced_out = true; }},
  };
  for (const auto& [fault, happens] : order) {
    happens();
    EXPECT_EQ(found(), fault) << describe(fault).name;
  }
}

TEST_F(FaultSearching, KnowsWhoHasTakenTheMachineAsTheTableDoes) {
  EXPECT_EQ(search.machineTaken(view), Fault::None);
  std::set<Fault> found_taken;
  const std::function<void(SupervisorView&)> causes[] = {
      [](SupervisorView& v) { v.measured.digital_inputs = 2; },
      [](SupervisorView& v) { v.measured.fenced_out = true; },
  };
  for (const auto& cause : causes) {
    SupervisorView taken = view;
    taken.verdict.fault[0] = Fault::Runaway;  // whatever else is wrong
    cause(taken);
    EXPECT_EQ(search.machineTaken(taken), search.find(taken, conditions).fault);
    found_taken.insert(search.machineTaken(taken));
  }
  for (int i = 0; i < kFaults; ++i) {
    const auto fault = static_cast<Fault>(i);
    EXPECT_EQ(takesTheMachine(fault), found_taken.count(fault) == 1) << describe(fault).name;
    EXPECT_EQ(describe(fault).stop == StopCategory::None, fault == Fault::None) << describe(fault).name;
  }
  view.measured.digital_inputs = 1;
  EXPECT_EQ(search.machineTaken(view), Fault::None) << "the hand switch leaves the drives their power";
}

TEST_F(FaultSearching, AsksForReadyDrivesOnlyWhileTheyDrive) {
  view.measured.digital_inputs = 3;
  for (const DriveLevel level : {DriveLevel::Off, DriveLevel::Energised}) {
    view.written.level = level;
    EXPECT_EQ(found(), Fault::None);
  }
  view.written.level = DriveLevel::HeldByDrivers;
  EXPECT_EQ(found(), Fault::DrivesNotReady);
}

TEST_F(FaultSearching, NamesTheAxisAndNoneForThePlatformAsAWhole) {
  view.verdict.fault[2] = Fault::Stalled;
  EXPECT_EQ(search.find(view, conditions).axis, 3);
  view.verdict.fault[2] = Fault::PatientSpeed;
  EXPECT_EQ(search.find(view, conditions).axis, 0);
}

TEST_F(FaultSearching, TakesALengthThatIsNoNumberForOutsideTheRangeAndOnlyOfAHomedRobotWithDrivesOn) {
  view.measured.position_m[1] = std::nan("");
  EXPECT_EQ(found(), Fault::PositionOutOfRange);
  EXPECT_EQ(search.find(view, conditions).axis, 2);
  conditions.homed = false;
  EXPECT_EQ(found(), Fault::None);
  conditions.homed = true;
  view.written.level = DriveLevel::Off;
  EXPECT_EQ(found(), Fault::None);
}

TEST_F(FaultSearching, AllowsTheMarginBeyondTheRangeAndNoMore) {
  view.measured.position_m[0] = 1.0049;
  EXPECT_EQ(found(), Fault::None);
  view.measured.position_m[0] = 1.0051;
  EXPECT_EQ(found(), Fault::PositionOutOfRange);
}

TEST_F(FaultSearching, LetsComponentsStandWhileDisabledAndNamesTheOneThatDoesNotRunOtherwise) {
  component.stop();
  conditions.disabled = true;
  EXPECT_EQ(found(), Fault::None);
  conditions.disabled = false;
  EXPECT_EQ(search.find(view, conditions).component, 0);
}

TEST_F(FaultSearching, SaysNothingOfInputsBeforeTheFirstMeasurement) {
  view.measured = AxesMeasurement{};
  EXPECT_EQ(found(), Fault::None);
}

TEST_F(FaultSearching, TheCauseRemainsWhileAnythingStillStops) {
  EXPECT_FALSE(search.causeRemains(Fault::Saturated, view));
  const std::function<void(SupervisorView&)> causes[] = {
      [](SupervisorView& v) { v.measured.bus_failure.fault = hardware::BusFault::BusOff; },
      [](SupervisorView& v) { v.measured.digital_inputs = 2; },
      [](SupervisorView& v) { v.measured.digital_inputs = 1; },
      [](SupervisorView& v) { v.unreadable = 1; },
      [](SupervisorView& v) { v.written.status = hardware::IoStatus::Disconnected; },
  };
  for (const auto& cause : causes) {
    SupervisorView now = view;
    cause(now);
    EXPECT_TRUE(search.causeRemains(Fault::Saturated, now));
  }
  component.stop();
  EXPECT_TRUE(search.causeRemains(Fault::Saturated, view));
}

TEST_F(FaultSearching, AHeatThatIsNoNumberCountsAsHot) {
  view.verdict.heat[3] = std::nan("");
  EXPECT_TRUE(search.causeRemains(Fault::ThermalOverload, view));
  EXPECT_FALSE(search.causeRemains(Fault::Stalled, view)) << "only a motor that was too hot has to cool";
}

TEST(FaultLatching, LetsAPlatformThatSinksTakeThePlaceOfAnotherFaultButNotOfABrakeThatSlips) {
  FaultLatch latch;
  latch.latch({Fault::EmergencyStop});
  EXPECT_TRUE(latch.latch({Fault::MovedWhileOff, 2}));
  EXPECT_FALSE(latch.latch({Fault::MovedWhileOff, 3}));
  EXPECT_FALSE(latch.latch({Fault::HandSwitch}));
  EXPECT_TRUE(latch.latch({Fault::HoldDeviceSlips, 3}));
  EXPECT_FALSE(latch.latch({Fault::MovedWhileOff, 1}));
  EXPECT_EQ(latch.cause().fault, Fault::HoldDeviceSlips);
}

TEST(FaultLatching, LetsAnAcuteFaultTakeThePlaceOfAnotherOnce) {
  FaultLatch latch;
  FaultCause lost{Fault::OutputLost};
  latch.latch({Fault::EmergencyStop});
  EXPECT_FALSE(latch.latch(lost));
  lost.acute = true;
  EXPECT_TRUE(latch.latch(lost));
  EXPECT_FALSE(latch.latch(lost));
  EXPECT_EQ(latch.cause().fault, Fault::OutputLost);
}

TEST(FaultLatching, KeepsTheFirstFaultUntilItIsCleared) {
  FaultLatch latch;
  EXPECT_FALSE(latch.latch({Fault::None}));
  EXPECT_FALSE(latch.isLatched());
  EXPECT_TRUE(latch.latch({Fault::Stalled, 2}));
  EXPECT_FALSE(latch.latch({Fault::EmergencyStop}));
  EXPECT_EQ(latch.cause().fault, Fault::Stalled);
  EXPECT_EQ(latch.cause().axis, 2);
  latch.clear();
  EXPECT_FALSE(latch.isLatched());
  EXPECT_TRUE(latch.latch({Fault::EmergencyStop}));
}

}  // namespace
}  // namespace knee_robot::control
