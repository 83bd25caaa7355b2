#pragma once

#include <cstdint>

#include "knee_robot/hardware/bus_failure.h"

namespace knee_robot::control {

/// Everything that leads to the safe stop and stays latched until it is reset.
enum class Fault : std::uint8_t {
  None,
  MeasurementLost,
  OutputLost,
  NotANumber,
  FollowingError,
  SetPointStale,
  SetPointJump,
  CommandStale,
  OrdersStale,
  PositionOutOfRange,
  ComponentException,
  ComponentFatal,
  ComponentStopped,
  Overrun,
  EnableTimeout,
  EmergencyStop,
  GuardianActed,
  NotReset,
  HandSwitch,
  SoftLimit,
  VelocityLimit,
  AccelerationLimit,
  Stalled,
  Runaway,
  EncoderFrozen,
  EncoderJump,
  Saturated,
  ThermalOverload,
  PatientPose,
  PatientSpeed,
  HomingFailed,
  BusDown,
  BusOff,
  BusFlooded,
  DriveLost,
  FeedbackLate,
  DriveHeartbeatLost,
  ControllerHeartbeatLost,
  DriveEmergency,
  DriveFault,
  DriveNotEnabled,
  MonitorsStale,
  GuardianSilent,
  HoldDeviceSlips,
  InputsStale,
  DriveTorque,
  PatientForce,
  AxisBlocked,
  DriveStaysOn,
  DrivesNotReady,
  MovedWhileOff,
  WeightOpposite,
};
inline constexpr int kFaults = 52;

/// When resetFaults() clears a fault.
enum class ResetRule : std::uint8_t {
  OnRequest,        ///< at once
  WhenCauseIsGone,  ///< refused while the cause is still there
  Restart,          ///< never in this process
};

/// What is left of the position loop of the axis that has the fault.
enum class Loop : std::uint8_t {
  Works,  ///< the safe stop may slow down along the path (SS1)
  Lost,   ///< the holding brakes engage at once; until they hold, the axis gets what carried it
};

/// Stop category of IEC 60204-1.
enum class StopCategory : std::uint8_t {
  None,
  Zero,        ///< hardware has taken the power: STO and SBC together
  One,         ///< power stays until the robot is at rest and the brakes hold: SS1, then SBC, then STO
  ByGuardian,  ///< One as well, but the guardian does it: SBC at once, STO when the brakes hold
};

/// One row of the fault table: what is said, how the robot stops, what resets it.
struct FaultDescription {
  Fault fault;
  const char* name;      ///< one word, as published
  const char* sentence;  ///< cause, for the operator
  ResetRule reset;
  Loop loop;
  StopCategory stop;
  const char* remedy;  ///< what to do before resetting
};

/// The one table of faults. Constant data; real-time safe.
const FaultDescription& describe(Fault fault) noexcept;

/// True for faults of the platform as a whole, whatever axis reports them.
bool concernsAllAxes(Fault fault) noexcept;

/// True where the drives' power or the outputs are not the controller's any more: its safe stop slows nothing down.
bool takesTheMachine(Fault fault) noexcept;

/// What the bus to the drives reports, as a fault of the machine.
Fault faultOf(hardware::BusFault fault) noexcept;

/// True when the axis' position loop still works with this fault, so that the safe stop may decelerate under control.
bool loopStaysClosed(Fault fault) noexcept;

}  // namespace knee_robot::control
