#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// The Supervisor's states.
enum class MachineState : std::uint8_t {
  Disabled,      ///< drives off, holding brakes engaged
  Enabling,      ///< 0 V, enable, take over, release
  Holding,       ///< Drivers hold the position
  Playing,       ///< Sync streams the reference
  Stopping,      ///< Sync slows down along the path
  SafeStopping,  ///< the safe stop runs
  Faulted,       ///< drives off, holding brakes engaged, fault latched
  Paused,        ///< at rest on the path; resume() goes on from there
  Homing,        ///< drives on, axes move slowly one after the other until each has found its reference
  Guiding,       ///< a hand moves the platform while the enabling switch is held
};
inline constexpr int kMachineStates = 10;
const char* toString(MachineState state) noexcept;
/// Sync plays a path, or rests on it.
constexpr bool isOnPath(MachineState state) noexcept {
  return state == MachineState::Playing || state == MachineState::Paused || state == MachineState::Stopping;
}

/// What the operator may ask for.
enum class RequestKind : std::uint8_t {
  Enable,
  Disable,
  Play,
  Stop,
  EmergencyStop,
  Reset,
  Pause,
  Resume,
  SetSpeed,     ///< value: 0 to 1
  Home,         ///< by the procedure of the hardware file
  ConfirmHome,  ///< the robot stands at home, says the operator
  Guide,        ///< a hand will move the platform
};
inline constexpr int kRequestKinds = 12;

/// Whether a request is possible in a state: the table of the machine. EmergencyStop always is.
bool isPossible(MachineState state, RequestKind request) noexcept;

/// Leads to rest, from whatever: obeyed however late it comes.
bool onlyStops(RequestKind request) noexcept;

/// What somebody asks of the Supervisor.
struct Request {
  std::uint32_t number = 0;  ///< the answer carries it
  RequestKind kind = RequestKind::Stop;
  double value = 0.0;  ///< of SetSpeed
  /// Time of the deployment's clock from which on nobody waits for it any more (TooLate), unless it only stops or slows
  /// down.
  rt::Nanoseconds expires = std::numeric_limits<rt::Nanoseconds>::max();
};

/// Why a request was refused, or that it was not.
enum class RequestResult : std::uint8_t {
  Done,
  WrongState,         ///< not possible in the present state
  NoReference,        ///< play without reference
  NotAtStart,         ///< play away from the first point
  NotReady,           ///< a component does not run or nothing is measured
  CauseRemains,       ///< reset while the fault's cause is still there
  NeedsRestart,       ///< reset of a fault that only a restart clears
  Superseded,         ///< another request came before it was done
  Failed,             ///< a fault came before it was done
  NotHomed,           ///< nobody knows yet where the axes are
  NoProcedure,        ///< home() where the hardware file leaves homing to the operator, or the other way round
  HomeShifted,        ///< a home that is confirmed anew lies far from what the counters say
  HomeMoves,          ///< a home that is confirmed while an axis moves
  OutOfRange,         ///< the value is not allowed
  NoEnablingSwitch,   ///< guide without such an input
  NoGuide,            ///< guide without a HandGuide in the deployment
  BrakesUntested,     ///< guide without brakes that are tested at enabling
  SwitchNotHeld,      ///< guide while the enabling switch is not held
  SwitchNotReleased,  ///< guide again without having let go of it
  GuideRefused,       ///< HandGuide says why: SupervisorStatus::guide_stop
  TooLate,            ///< the Supervisor heard of it when it had expired
};

/// What became of a Request.
struct RequestAnswer {
  std::uint32_t number = 0;  ///< of the request; 0: none yet
  RequestResult result = RequestResult::Done;
  int axis = 0;             ///< NotAtStart, HomeShifted, HomeMoves: 1 to 4
  double distance_m = 0.0;  ///< likewise
};

/// Supervisor, every servo cycle.
struct SupervisorStatus {
  static constexpr std::size_t kAnswers = 16;

  rt::Nanoseconds time = 0;  ///< of the cycle
  MachineState state = MachineState::Disabled;
  Fault fault = Fault::None;
  int fault_axis = 0;                             ///< 1 to 4, 0: none in particular
  int fault_component = -1;                       ///< index in the list of watched components, -1: none in particular
  std::uint16_t fault_code = 0;                   ///< emergency code of the axis' drive, 0: none
  double fault_paused_s = 0.0;                    ///< FaultCause::paused_s
  std::array<RequestAnswer, kAnswers> answers{};  ///< to request n at n modulo kAnswers
  double path_time_s = 0.0;
  double path_duration_s = 0.0;
  double time_scale = 0.0;                    ///< speed of path time now, 0 to 1
  double speed = 1.0;                         ///< asked for, 0 to 1
  bool pause_path = false;                    ///< asked for, and not taken back
  std::array<bool, hardware::kAxes> homed{};  ///< axes that know where they are
  std::uint32_t safe_stops = 0;
  GuideStop guide_stop = GuideStop::None;  ///< why the last guiding was refused, or ended by itself
};

}  // namespace knee_robot::control
