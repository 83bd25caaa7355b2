#include "fault_search.h"

#include <algorithm>

namespace knee_robot::control {
namespace {

constexpr double kCool = 0.8;  // of what is allowed, before a motor that was too hot may go on

FaultCause ofBus(const hardware::BusFailure& failure) noexcept {
  return {faultOf(failure.fault), failure.axis, -1, failure.code};
}

FaultCause ofDrivers(const SupervisorView& view) noexcept {
  for (const AxisCommand& command : view.commands) {
    if (command.fault != Fault::None) return {command.fault, concernsAllAxes(command.fault) ? 0 : command.axis};
  }
  return {};
}

}  // namespace

Fault FaultSearch::machineTaken(const SupervisorView& view) const noexcept {
  // First: after a pause of the whole process nearly everything else looks wrong, too.
  if (view.measured.fenced_out) return Fault::GuardianActed;
  if (inputs_.emergencyStop(view.measured)) return Fault::EmergencyStop;
  return Fault::None;
}

FaultCause FaultSearch::find(const SupervisorView& view, const Conditions& conditions) const noexcept {
  // Before all others: what drives without power complain about is not the cause.
  if (const Fault taken = machineTaken(view); taken != Fault::None) return {taken};
  if (inputs_.handSwitch(view.measured)) return {Fault::HandSwitch};
  const bool driven = view.written.level >= DriveLevel::HeldByDrivers;
  if (driven && inputs_.drivesNotReady(view.measured)) return {Fault::DrivesNotReady};
  if (const FaultCause found = ofBus(view.measured.bus_failure); found.fault != Fault::None) return found;
  if (const FaultCause found = components_.firstFailure(conditions.disabled); found.fault != Fault::None) return found;
  if (const FaultCause found = inMeasurement(view, conditions); found.fault != Fault::None) return found;
  // Before the Drivers' faults: a monitor knows more about the cause of what makes a loop fail.
  if (const FaultCause found = ofMonitors(view, conditions); found.fault != Fault::None) return found;
  if (const FaultCause found = ofDrivers(view); found.fault != Fault::None) return found;
  if (view.written.fault != Fault::None) return {view.written.fault, view.written.fault_axis};
  if (conditions.overrun) return {Fault::Overrun};
  return {};
}

FaultCause FaultSearch::inSafeStop(const SupervisorView& view) const noexcept {
  FaultCause found;
  if (view.written.safe_stop == SafeStopPhase::Carrying) {
    found = {Fault::HoldDeviceSlips, view.written.fault_axis};
  } else if (view.written.unordered && view.written.safe_stop != SafeStopPhase::Idle) {
    found = {Fault::OutputLost};
  }
  found.acute = true;
  return found;
}

FaultCause FaultSearch::inMeasurement(const SupervisorView& view, const Conditions& conditions) const noexcept {
  if (!view.hasMeasured()) return {};  // before the first cycle; enabling is refused
  if (view.unreadable >= conditions.stale_cycles) return {Fault::MeasurementLost};
  if (view.written.status != hardware::IoStatus::Ok && view.written.sequence != 0) return {Fault::OutputLost};
  if (view.drivesAreOff() || !conditions.homed) return {};
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot_.actuators[i];
    const double position = view.measured.position_m[i];
    // Written so that what is not a number counts as outside.
    const bool inside = position >= actuator.position_min_m - conditions.range_margin_m &&
                        position <= actuator.position_max_m + conditions.range_margin_m;
    if (!inside) return {Fault::PositionOutOfRange, static_cast<int>(i) + 1};
  }
  return {};
}

/// A dead encoder comes first: it makes other axes run.
FaultCause FaultSearch::ofMonitors(const SupervisorView& view, const Conditions& conditions) const noexcept {
  if (view.unmonitored >= conditions.stale_cycles && view.hasMeasured() && view.unreadable == 0)
    return {Fault::MonitorsStale};
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (view.verdict.fault[i] == Fault::EncoderFrozen) return {Fault::EncoderFrozen, static_cast<int>(i) + 1};
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const Fault fault = view.verdict.fault[i];
    if (fault != Fault::None) return {fault, concernsAllAxes(fault) ? 0 : static_cast<int>(i) + 1};
  }
  return {};
}

bool FaultSearch::causeRemains(Fault latched, const SupervisorView& view) const noexcept {
  if (view.measured.bus_failure.fault != hardware::BusFault::None) return true;
  if (inputs_.anyStop(view.measured)) return true;
  // Written so that what is not a number counts as hot.
  const auto is_cool = [](double heat) { return heat <= kCool; };
  const bool cool = std::all_of(view.verdict.heat.begin(), view.verdict.heat.end(), is_cool);
  // These may have taken the place of the fault that stopped the robot.
  const bool took_its_place =
      latched == Fault::HoldDeviceSlips || latched == Fault::MovedWhileOff || latched == Fault::OutputLost;
  const bool heats = latched == Fault::ThermalOverload || took_its_place;
  if (heats && !cool) return true;
  if (view.unreadable != 0 || view.written.status != hardware::IoStatus::Ok) return true;
  return !components_.allRun();
}

}  // namespace knee_robot::control
