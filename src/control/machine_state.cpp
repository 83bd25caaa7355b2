#include "knee_robot/control/machine_state.h"

#include "knee_robot/control/supervisor.h"

namespace knee_robot {
namespace {

constexpr int kStates = 7;
constexpr int kRequests = 6;

/// Rows: Disabled, Enabling, Holding, Playing, Stopping, SafeStopping, Faulted.
/// Columns: Enable, Disable, Play, Stop, EmergencyStop, Reset.
constexpr bool kPossible[kStates][kRequests] = {
    {true, true, false, true, true, false},    // Disabled: nothing to disable or to stop is fine
    {false, true, false, false, true, false},  // Enabling
    {false, true, true, true, true, false},    // Holding
    {false, true, false, true, true, false},   // Playing
    {false, true, false, true, true, false},   // Stopping
    {false, true, false, true, true, false},   // SafeStopping
    {false, false, false, true, true, true},   // Faulted
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
  }
  return "?";
}

bool isPossible(MachineState state, RequestKind request) noexcept {
  return kPossible[static_cast<int>(state)][static_cast<int>(request)];
}

}  // namespace knee_robot
