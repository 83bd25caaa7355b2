// What the Supervisor looks at, and what it takes for a fault.
#include "knee_robot/control/supervisor.h"

namespace knee_robot::control {
namespace {

constexpr double kCool = 0.8;  // of what is allowed, before a motor that was too hot may go on

Fault faultOf(hardware::BusFault fault) noexcept {
  switch (fault) {
    case hardware::BusFault::None:
      return Fault::None;
    case hardware::BusFault::InterfaceDown:
      return Fault::BusDown;
    case hardware::BusFault::BusOff:
      return Fault::BusOff;
    case hardware::BusFault::Flooded:
      return Fault::BusFlooded;
    case hardware::BusFault::DriveLost:
      return Fault::DriveLost;
    case hardware::BusFault::FeedbackLate:
      return Fault::FeedbackLate;
    case hardware::BusFault::DriveHeartbeatLost:
      return Fault::DriveHeartbeatLost;
    case hardware::BusFault::ControllerHeartbeatLost:
      return Fault::ControllerHeartbeatLost;
    case hardware::BusFault::DriveEmergency:
      return Fault::DriveEmergency;
    case hardware::BusFault::DriveFault:
      return Fault::DriveFault;
    case hardware::BusFault::DriveNotEnabled:
      return Fault::DriveNotEnabled;
    case hardware::BusFault::InputsStale:
      return Fault::InputsStale;
    case hardware::BusFault::TorqueDeviates:
      return Fault::DriveTorque;
    case hardware::BusFault::GuardianSilent:
      return Fault::GuardianSilent;
  }
  return Fault::None;
}

}  // namespace

/// The first fault is latched; drives that are on are brought to rest by the safe stop first.
void Supervisor::raise(Fault fault, int axis, int component) noexcept {
  if (fault == Fault::None || status_.fault != Fault::None) return;
  status_.fault = fault;
  status_.fault_axis = axis;
  status_.fault_component = component;
  if (status_.state == MachineState::SafeStopping) return;  // that was asked for; it now ends in Faulted
  settlePending(RequestResult::Failed);
  status_.state =
      drivesAreOff() && orders_.level == DriveLevel::Off ? MachineState::Faulted : MachineState::SafeStopping;
}

void Supervisor::lookForFaults() {
  // Before all others: after a pause of the whole process nearly everything else looks wrong, too.
  if (measured_.fenced_out) raise(Fault::GuardianActed, 0);
  lookAtInputs();  // an emergency stop takes the power of the drives: what they complain about is not its cause
  raise(faultOf(measured_.bus_failure.fault), measured_.bus_failure.axis);
  lookAtComponents();
  lookAtMeasurement();
  lookAtMonitors();
  for (const AxisCommand& command : commands_) {
    raise(command.fault, concernsAllAxes(command.fault) ? 0 : command.axis);
  }
  raise(written_.fault, written_.fault_axis);
  if (overrun_.exchange(false, std::memory_order_relaxed)) raise(Fault::Overrun, 0);
}

/// Before the Drivers' faults: a monitor knows more about the cause of what makes a loop fail. A dead encoder comes first: it makes other axes run.
void Supervisor::lookAtMonitors() {
  if (unjudged_ >= stale_measurements && measured_.sequence != 0 && unreadable_ == 0) raise(Fault::MonitorsStale, 0);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (verdict_.fault[i] == Fault::EncoderFrozen) raise(Fault::EncoderFrozen, static_cast<int>(i) + 1);
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const Fault fault = verdict_.fault[i];
    raise(fault, concernsAllAxes(fault) ? 0 : static_cast<int>(i) + 1);
    if (fault == Fault::EncoderJump) status_.homed[i] = false;  // its counts mean nothing any more
  }
}

void Supervisor::lookAtInputs() {
  if (emergencyInput()) raise(Fault::EmergencyStop, 0);
  if (inputIsLow(hardware_.hand_switch_clear_bit)) raise(Fault::HandSwitch, 0);
}

void Supervisor::lookAtComponents() {
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const int index = static_cast<int>(i);
    switch (watched_[i]->state()) {
      case rt::TaskState::Running:
        break;
      case rt::TaskState::Exception:
        raise(Fault::ComponentException, 0, index);
        break;
      case rt::TaskState::FatalError:
        raise(Fault::ComponentFatal, 0, index);
        break;
      case rt::TaskState::RunTimeError:
      case rt::TaskState::PreOperational:
      case rt::TaskState::Stopped:
        if (status_.state != MachineState::Disabled) raise(Fault::ComponentStopped, 0, index);
        break;
    }
  }
}

void Supervisor::lookAtMeasurement() {
  if (measured_.sequence == 0) return;  // before the first cycle; enabling is refused
  if (unreadable_ >= stale_measurements) raise(Fault::MeasurementLost, 0);
  if (written_.status != hardware::IoStatus::Ok && written_.sequence != 0) raise(Fault::OutputLost, 0);
  if (drivesAreOff() || !orders_.homed) return;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot_.actuators[i];
    const double position = measured_.position_m[i];
    // Written so that what is not a number counts as outside.
    const bool inside =
        position >= actuator.position_min_m - range_margin && position <= actuator.position_max_m + range_margin;
    if (!inside) raise(Fault::PositionOutOfRange, static_cast<int>(i) + 1);
  }
}

bool Supervisor::emergencyInput() const noexcept {
  return inputIsLow(hardware_.emergency_stop_clear_bit);
}

bool Supervisor::inputIsLow(const std::optional<int>& bit) const noexcept {
  if (!bit || measured_.sequence == 0) return false;
  return (measured_.digital_inputs >> *bit & 1) == 0;
}

bool Supervisor::causeRemains() const noexcept {
  if (measured_.bus_failure.fault != hardware::BusFault::None) return true;
  if (emergencyInput() || inputIsLow(hardware_.hand_switch_clear_bit)) return true;
  if (status_.fault == Fault::ThermalOverload) {
    for (const double heat : verdict_.heat) {
      if (!(heat <= kCool)) return true;
    }
  }
  if (unreadable_ != 0 || written_.status != hardware::IoStatus::Ok) return true;
  for (const rt::TaskContext* one : watched_) {
    if (one->state() != rt::TaskState::Running) return true;
  }
  return false;
}

}  // namespace knee_robot::control
