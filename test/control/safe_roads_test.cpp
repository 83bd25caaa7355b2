// Every road out of Running: the safe stop runs exactly once, on all four channels, in its order, and the platform
// stays up.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "system_rig.h"

namespace knee_robot::control {
namespace {

using fake::Machine;
using fake::Rig;

struct Road {
  std::string name;
  std::function<void(Rig&)> leave;
  Fault fault;
  bool decelerates;      // the loops go on, so the stop is along the path
  double drop_m = 1e-3;  // allowed fall of any axis below its lowest reference
  bool blind = false;    // no loop is left, or no power: nobody could take the load back
};

const std::vector<Road>& roads() {
  static const std::vector<Road> kRoads = {
      {"Disable", [](Rig& rig) { rig.system.disable(); }, Fault::None, true},
      {"EmergencyStop", [](Rig& rig) { rig.system.emergencyStop(); }, Fault::EmergencyStop, true},
      {"SyncException", [](Rig& rig) { rig.injection.throws = "Sync"; }, Fault::ComponentException, true},
      {"SyncFatal", [](Rig& rig) { rig.injection.fatal = "Sync"; }, Fault::ComponentFatal, true},
      {"SyncSilent", [](Rig& rig) { rig.injection.silent = "Sync"; }, Fault::SetPointStale, true},
      {"RecorderException", [](Rig& rig) { rig.injection.throws = "Recorder"; }, Fault::ComponentException, true},
      {"RecorderFatal", [](Rig& rig) { rig.injection.fatal = "Recorder"; }, Fault::ComponentFatal, true},
      {"Driver1Exception", [](Rig& rig) { rig.injection.throws = "Driver1"; }, Fault::ComponentException, false, 3e-3},
      {"Driver4Exception", [](Rig& rig) { rig.injection.throws = "Driver4"; }, Fault::ComponentException, false, 3e-3},
      {"Driver2Fatal", [](Rig& rig) { rig.injection.fatal = "Driver2"; }, Fault::ComponentFatal, false, 3e-3},
      {"Driver3Silent", [](Rig& rig) { rig.injection.silent = "Driver3"; }, Fault::CommandStale, false, 3e-3},
      {"InputException", [](Rig& rig) { rig.injection.throws = "AxesInput"; }, Fault::ComponentException, false, 3e-3,
       true},
      {"InputSilent", [](Rig& rig) { rig.injection.silent = "AxesInput"; }, Fault::MeasurementLost, false, 3e-3, true},
      {"EncodersUnreadable", [](Rig& rig) { rig.machine.read_status = hardware::IoStatus::Disconnected; },
       Fault::MeasurementLost, false, 3e-3, true},
      {"SupervisorSilent", [](Rig& rig) { rig.injection.silent = "Supervisor"; }, Fault::OrdersStale, true},
      {"SupervisorException", [](Rig& rig) { rig.injection.throws = "Supervisor"; }, Fault::ComponentException, true},
      {"Overrun",
       [](Rig& rig) { dynamic_cast<Supervisor&>(*rig.system.deployment().component("Supervisor")).reportOverrun(); },
       Fault::Overrun, true},
      {"DriverStopped", [](Rig& rig) { rig.system.deployment().component("Driver2")->stop(); }, Fault::ComponentStopped,
       false, 3e-3},
      {"BlockedHard", [](Rig& rig) { rig.machine.axes[1].jammed = true; }, Fault::AxisBlocked, false, 3e-3},
      {"HandSwitch", [](Rig& rig) { rig.machine.inputs = 0xd; }, Fault::HandSwitch, true},
      {"EmergencyStopsInput", [](Rig& rig) { rig.machine.inputs = 0xe; }, Fault::EmergencyStop, false, 3e-3, true},
      {"MonitorsException", [](Rig& rig) { rig.injection.throws = "Monitors"; }, Fault::ComponentException, true},
      {"MonitorsFatal", [](Rig& rig) { rig.injection.fatal = "Monitors"; }, Fault::ComponentFatal, true},
      {"MonitorsSilent", [](Rig& rig) { rig.injection.silent = "Monitors"; }, Fault::MonitorsStale, true},
      {"BlackBoxException", [](Rig& rig) { rig.injection.throws = "BlackBox"; }, Fault::ComponentException, true},
      {"PausedThenDisabled",
       [](Rig& rig) {
         rig.system.pause();
         rig.system.disable();
       },
       Fault::None, true},
      {"PausedThenSyncSilent",
       [](Rig& rig) {
         rig.system.pause();
         rig.injection.silent = "Sync";
       },
       Fault::SetPointStale, true},
      // The axes of the fake machine do not feel each other: no other axis says that this one moves.
      {"EncoderFrozen", [](Rig& rig) { rig.machine.axes[0].encoder_frozen = true; }, Fault::AxisBlocked, false, 3e-3},
      {"EncoderFrozenOnTheHeavyAxis", [](Rig& rig) { rig.machine.axes[3].encoder_frozen = true; }, Fault::AxisBlocked,
       false, 3e-3},
      {"EncoderJumped", [](Rig& rig) { rig.machine.axes[2].encoder_offset_m = 0.01; }, Fault::EncoderJump, false, 3e-3},
      {"EncoderJumpedBack", [](Rig& rig) { rig.machine.axes[1].encoder_offset_m = -0.004; }, Fault::EncoderJump, false,
       3e-3},
      {"DriveDead", [](Rig& rig) { rig.machine.axes[0].drive_dead = true; }, Fault::Runaway, false, 15e-3},
      {"DriveDeadOnTheHeavyAxis", [](Rig& rig) { rig.machine.axes[3].drive_dead = true; }, Fault::Runaway, false,
       15e-3},
      {"WrongSign", [](Rig& rig) { rig.machine.axes[1].wrong_sign = true; }, Fault::Runaway, false, 25e-3},
      {"Struck", [](Rig& rig) { rig.machine.axes[0].push_N = 600.0; }, Fault::Runaway, false, 15e-3},
  };
  return kRoads;
}

/// Order in which the wires changed after `from`: 'e' hold engages, 'd' drive disabled, 'z' 0 V on all four at once.
struct Wires {
  std::string order;
  int runs = 0;  // times that the holding brakes were engaged
  double engage_s = 0.0, disable_s = 0.0, zero_s = 0.0;
};

Wires wiresAfter(const Machine& machine, double from) {
  Wires wires;
  bool enabled = true, released = true, zero = false;
  for (const Machine::Event& event : machine.events) {
    if (event.time_s < from) continue;
    const bool e = event.bits & 1, r = event.bits & 2, z = event.volts == AxisValues{};
    if (released && !r) {
      wires.order += 'e';
      wires.engage_s = event.time_s;
      ++wires.runs;
    }
    if (enabled && !e) {
      wires.order += 'd';
      wires.disable_s = event.time_s;
    }
    if (!zero && z) {
      wires.order += 'z';
      wires.zero_s = event.time_s;
    }
    EXPECT_FALSE(zero && !z) << "volts came back at " << event.time_s;
    EXPECT_FALSE(!released && r) << "the holding brake opened again at " << event.time_s;
    EXPECT_FALSE(!enabled && e) << "the drive was enabled again at " << event.time_s;
    enabled = e;
    released = r;
    zero = z;
  }
  return wires;
}

/// Faults that show only in the motion that follows from their cause.
bool needsTime(Fault fault) {
  return fault == Fault::AxisBlocked || fault == Fault::Runaway;
}

HardwareFile withInputs() {
  HardwareFile hardware = fake::hardware();
  hardware.emergency_stop_clear_bit = 0;
  hardware.hand_switch_clear_bit = 1;
  return hardware;
}

class SafeRoads : public ::testing::TestWithParam<Road> {};

TEST_P(SafeRoads, RunTheSafeStopOnceOnAllFourChannels) {
  const Road& road = GetParam();
  Rig rig(withInputs());
  ASSERT_NO_FATAL_FAILURE(rig.play());
  const double left = rig.machine.time_s;
  const double lowest_before = rig.lowest();
  road.leave(rig);
  rig.system.run(2.5);

  const Wires wires = wiresAfter(rig.machine, left);
  // With a loop that works the force goes down, watched, before the drives go off; without, it stays until they are off.
  EXPECT_EQ(wires.order, road.blind ? "edz" : "ezd") << "engage, disable, zero";
  EXPECT_EQ(wires.runs, 1);
  EXPECT_GE(wires.disable_s - wires.engage_s, 0.03 - 1e-9) << "the brake's delay was waited for";
  if (!road.blind) {
    EXPECT_GE(wires.zero_s - wires.engage_s, 0.03 + 0.07) << "the brake's delay, then the force down in 80 ms";
    EXPECT_LE(wires.disable_s - wires.engage_s, 0.03 + 0.05 + 0.08 + 0.02 + 0.005) << "no longer than it takes";
  } else {
    EXPECT_GE(wires.zero_s - wires.disable_s, 0.02 - 1e-9) << "the drive was off before 0 V";
  }
  // As the table says; a component of the loop takes the loop with it, and a service takes no power.
  const bool of_the_loop = road.name.find("Driver") == 0 || road.name.find("Input") == 0;
  const bool by_service = road.name == "EmergencyStop";
  if (const FaultDescription& row = describe(road.fault); road.fault != Fault::None && !of_the_loop && !by_service) {
    EXPECT_EQ(road.decelerates, !takesTheMachine(row.fault) && row.loop == Loop::Works) << row.name;
  }
  const double until_engaged = wires.engage_s - left;
  if (road.decelerates) {
    EXPECT_GT(until_engaged, 0.1);
  } else {
    EXPECT_LT(until_engaged, needsTime(road.fault) ? 0.3 : 0.01);
  }
  EXPECT_GT(rig.lowest(), lowest_before - road.drop_m);
  for (const auto& axis : rig.machine.axes)
    EXPECT_EQ(axis.velocity, 0.0);

  const ControlStatus status = rig.system.status();
  EXPECT_EQ(status.fault, road.fault) << status.fault_sentence;
  if (road.fault != Fault::None) {
    EXPECT_EQ(status.state, MachineState::Faulted);
    EXPECT_FALSE(status.fault_sentence.empty());
    EXPECT_FALSE(rig.system.enable().ok) << "latched";
  }
  std::printf("%-20s hold engaged after %6.1f ms, %s\n", road.name.c_str(), 1e3 * until_engaged,
              status.fault_sentence.c_str());
}

std::vector<Road> all() {
  return roads();
}
INSTANTIATE_TEST_SUITE_P(All, SafeRoads, ::testing::ValuesIn(all()),
                         [](const ::testing::TestParamInfo<Road>& info) { return info.param.name; });

TEST(SafeRoad, OfAxesOutputsOwnExceptionEngagesDisablesAndZeroesAtOnce) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  const double left = rig.machine.time_s;
  rig.injection.throws = "AxesOutput";
  rig.system.run(0.1);
  EXPECT_EQ(rig.machine.bits, 0u);
  EXPECT_EQ(rig.machine.volts, AxisValues{});
  EXPECT_EQ(rig.injection.stops["AxesOutput"], 1);
  EXPECT_EQ(wiresAfter(rig.machine, left).runs, 1);
  EXPECT_EQ(rig.system.state(), MachineState::Faulted);
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
  rig.injection.throws.clear();
  const Answer reset = rig.system.resetFaults();
  EXPECT_TRUE(reset.ok) << reset.sentence;
  EXPECT_TRUE(rig.system.enable().ok);
}

TEST(SafeRoad, OfAShutdownWhilePlayingIsTheWholeSafeStop) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  const double left = rig.machine.time_s;
  const Answer answer = rig.system.shutdown();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  EXPECT_EQ(wiresAfter(rig.machine, left).order, "ezd");
  EXPECT_EQ(rig.machine.bits, 0u) << "the heartbeat rests, too";
}

TEST(SafeRoad, OfComponentsStoppedBehindTheControllersBackStillEndsSafe) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.system.deployment().component("AxesOutput")->stop();
  EXPECT_EQ(rig.machine.bits, 0u);
  EXPECT_EQ(rig.machine.volts, AxisValues{});
}

TEST(SafeRoad, OfADeadOutputCardIsTriedToTheEndAndNamed) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.machine.volts_status = hardware::IoStatus::DeviceError;
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "output_lost");
  EXPECT_EQ(rig.machine.bits & 3u, 0u) << "brake and enable are on the other card";
  EXPECT_FALSE(rig.system.resetFaults().ok) << "the card is still dead";
}

TEST(SafeRoad, LeadsBackThroughResetAndEnableAfterAnException) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.injection.throws = "Driver2";
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  const std::string sentence = rig.system.status().fault_sentence;
  EXPECT_EQ(sentence.rfind("Driver2: injected: ", 0), 0u) << sentence;
  EXPECT_EQ(rig.injection.stops["Driver2"], 1);
  rig.injection.throws.clear();
  const Answer reset = rig.system.resetFaults();
  ASSERT_TRUE(reset.ok) << reset.sentence;
  const double stood = rig.machine.axes[0].position;
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(1.0);
  EXPECT_EQ(rig.system.state(), MachineState::Holding) << "and not playing";
  EXPECT_NEAR(rig.machine.axes[0].position, stood, 1e-3);
}

TEST(SafeRoad, OfAFatalErrorNeedsARestart) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.injection.fatal = "Driver3";
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  rig.injection.fatal.clear();
  EXPECT_FALSE(rig.system.resetFaults().ok);
  EXPECT_EQ(rig.system.state(), MachineState::Faulted);
}

TEST(SafeRoad, OfAFailedSupervisorLeadsBackToo) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.injection.throws = "Supervisor";
  rig.system.run(0.03);  // AxesOutput has just begun
  rig.injection.throws.clear();
  const double lowest = rig.lowest();
  const Answer reset = rig.system.resetFaults();
  EXPECT_TRUE(reset.ok) << reset.sentence;
  EXPECT_EQ(rig.system.state(), MachineState::Disabled);
  EXPECT_GT(rig.lowest(), lowest - 1e-3);
  EXPECT_TRUE(rig.system.enable().ok);
}

}  // namespace
}  // namespace knee_robot::control
