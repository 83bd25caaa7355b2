#include "knee_robot/control/machine_state.h"

#include "knee_robot/control/supervisor.h"

namespace knee_robot::control {
namespace {

/// Rows: Disabled, Enabling, Holding, Playing, Stopping, SafeStopping, Faulted, Paused, Homing.
/// Columns: Enable, Disable, Play, Stop, EmergencyStop, Reset, Pause, Resume, SetSpeed, Home, ConfirmHome.
constexpr bool kPossible[kMachineStates][kRequestKinds] = {
    {true, true, false, true, true, false, false, false, true, true, true},      // Disabled: nothing to stop is fine
    {false, true, false, false, true, false, false, false, true, false, false},  // Enabling
    {false, true, true, true, true, false, false, false, true, false, false},    // Holding
    {false, true, false, true, true, false, true, true, true, false, false},     // Playing
    {false, true, false, true, true, false, false, false, true, false, false},   // Stopping
    {false, true, false, true, true, false, false, false, true, false, false},   // SafeStopping
    {false, false, false, true, true, true, false, false, true, false, false},   // Faulted
    {false, true, false, true, true, false, true, true, true, false, false},     // Paused
    {false, true, false, true, true, false, false, false, true, false, false},   // Homing
};

}  // namespace

const char* toString(MachineState state) noexcept {
  switch (state) {
    case MachineState::Disabled:
      return "disabled";
    case MachineState::Enabling:
      return "enabling";
    case MachineState::Holding:
      return "holding";
    case MachineState::Playing:
      return "playing";
    case MachineState::Stopping:
      return "stopping";
    case MachineState::SafeStopping:
      return "safe_stopping";
    case MachineState::Faulted:
      return "faulted";
    case MachineState::Paused:
      return "paused";
    case MachineState::Homing:
      return "homing";
  }
  return "?";
}

bool isPossible(MachineState state, RequestKind request) noexcept {
  return kPossible[static_cast<int>(state)][static_cast<int>(request)];
}

}  // namespace knee_robot::control
