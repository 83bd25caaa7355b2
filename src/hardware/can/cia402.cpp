#include "knee_robot/hardware/can/cia402.h"

namespace knee_robot::hardware::can {

DriveState stateOf(std::uint16_t status_word) noexcept {
  switch (status_word & 0x4F) {
    case 0x00:
      return DriveState::NotReady;
    case 0x40:
      return DriveState::SwitchOnDisabled;
    case 0x0F:
      return DriveState::FaultReaction;
    case 0x08:
      return DriveState::Fault;
    default:
      break;
  }
  switch (status_word & 0x6F) {
    case 0x21:
      return DriveState::ReadyToSwitchOn;
    case 0x23:
      return DriveState::SwitchedOn;
    case 0x27:
      return DriveState::OperationEnabled;
    case 0x07:
      return DriveState::QuickStopActive;
    default:
      return DriveState::Unknown;
  }
}

std::uint16_t controlWord(DriveState state, DriveGoal goal) noexcept {
  const bool on = state == DriveState::OperationEnabled || state == DriveState::QuickStopActive;
  if (goal == DriveGoal::QuickStop) return on ? kQuickStop : kDisableVoltage;
  if (goal == DriveGoal::Off) return state == DriveState::OperationEnabled ? kShutdown : kDisableVoltage;
  switch (state) {
    case DriveState::SwitchOnDisabled:
      return kShutdown;
    case DriveState::ReadyToSwitchOn:
      return kSwitchOn;
    case DriveState::SwitchedOn:
    case DriveState::OperationEnabled:
      return kEnableOperation;
    case DriveState::NotReady:
    case DriveState::QuickStopActive:
    case DriveState::FaultReaction:
    case DriveState::Fault:
    case DriveState::Unknown:
      return kDisableVoltage;
  }
  return kDisableVoltage;
}

std::uint16_t FaultReset::controlWord(DriveState state, std::uint16_t usual) noexcept {
  if (cycles_ == 0) return usual;
  --cycles_;
  if (state != DriveState::Fault) {
    if (state != DriveState::FaultReaction) cycles_ = 0;
    return usual;
  }
  return (cycles_ & 1) != 0 ? kDisableVoltage : kFaultReset;
}

const char* toText(DriveState state) noexcept {
  switch (state) {
    case DriveState::NotReady:
      return "not ready to switch on";
    case DriveState::SwitchOnDisabled:
      return "switch on disabled";
    case DriveState::ReadyToSwitchOn:
      return "ready to switch on";
    case DriveState::SwitchedOn:
      return "switched on";
    case DriveState::OperationEnabled:
      return "operation enabled";
    case DriveState::QuickStopActive:
      return "quick stop active";
    case DriveState::FaultReaction:
      return "fault reaction active";
    case DriveState::Fault:
      return "fault";
    case DriveState::Unknown:
      break;
  }
  return "unknown";
}

}  // namespace knee_robot::hardware::can
