#include "knee_robot/control/machine_state.h"

namespace knee_robot::control {
namespace {

/// Rows: Disabled, Enabling, Holding, Playing, Stopping, SafeStopping, Faulted, Paused, Homing, Guiding.
/// Columns: Enable, Disable, Play, Stop, EmergencyStop, Reset, Pause, Resume, SetSpeed, Home, ConfirmHome, Guide.
constexpr bool kPossible[kMachineStates][kRequestKinds] = {
    {true, true, false, true, true, false, false, false, true, true, true, false},  // Disabled: nothing to stop is fine
    {false, true, false, false, true, false, false, false, true, false, false, false},  // Enabling
    {false, true, true, true, true, false, false, false, true, false, false, true},     // Holding
    {false, true, false, true, true, false, true, true, true, false, false, false},     // Playing
    {false, true, false, true, true, false, false, false, true, false, false, false},   // Stopping
    {false, true, false, true, true, false, false, false, true, false, false, false},   // SafeStopping
    {false, false, false, true, true, true, false, false, true, false, false, false},   // Faulted
    {false, true, false, true, true, false, true, true, true, false, false, false},     // Paused
    {false, true, false, true, true, false, false, false, true, false, false, false},   // Homing
    {false, true, false, true, true, false, false, false, true, false, false, false},   // Guiding
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
    case MachineState::Guiding:
      return "guiding";
  }
  return "?";
}

bool onlyStops(RequestKind request) noexcept {
  return request == RequestKind::Disable || request == RequestKind::Stop || request == RequestKind::EmergencyStop ||
         request == RequestKind::Pause;
}

bool isPossible(MachineState state, RequestKind request) noexcept {
  return kPossible[static_cast<int>(state)][static_cast<int>(request)];
}

}  // namespace knee_robot::control
