#include "knee_robot/control/faults.h"

#include <array>

namespace knee_robot::control {
namespace {

using F = Fault;
constexpr ResetRule kAtOnce = ResetRule::OnRequest;
constexpr ResetRule kWhenGone = ResetRule::WhenCauseIsGone;

constexpr std::array<FaultDescription, kFaults> kTable = {{
    {F::None, "none", "no fault", kAtOnce, ""},
    {F::MeasurementLost, "measurement_lost", "the encoders could not be read", kWhenGone,
     "check the counter card and its cable"},
    {F::OutputLost, "output_lost", "the outputs could not be written", kWhenGone,
     "check the analog and the digital outputs"},
    {F::NotANumber, "not_a_number", "a reference, a measurement or a command was not a number", kAtOnce,
     "find out where it came from: this is a fault of the program or of its data"},
    {F::FollowingError, "following_error", "the axis did not follow its reference", kAtOnce,
     "look for an obstacle, a brake that did not open, a reference that is too fast, a wrong sign"},
    {F::SetPointStale, "set_point_stale", "a set point of Sync came too late, or not at all", kWhenGone,
     "look at the state and the timing of Sync"},
    {F::SetPointJump, "set_point_jump", "the set point jumped", kAtOnce, "load the reference again"},
    {F::CommandStale, "command_stale", "no new command came from the axis' Driver", kWhenGone,
     "look at the state and the timing of the Driver and at the deployment's connections"},
    {F::OrdersStale, "orders_stale", "no new orders came from the Supervisor", kWhenGone,
     "look at the state and the timing of the Supervisor"},
    {F::PositionOutOfRange, "position_out_of_range", "the axis left its range", kAtOnce,
     "move it back by hand with the drives off, check the home position"},
    {F::ComponentException, "component_exception", "a component failed with an exception", kWhenGone,
     "resetting recovers the component"},
    {F::ComponentFatal, "component_fatal", "a component failed for good", ResetRule::Restart, "restart the controller"},
    {F::ComponentStopped, "component_stopped", "a component that is needed does not run", kWhenGone,
     "resetting starts the component again"},
    {F::Overrun, "overrun", "the servo cycle was late too many times in a row", kAtOnce,
     "look for what takes the processor: the deployment's priorities, other programs, the machine"},
    {F::EnableTimeout, "enable_timeout", "the drives could not be enabled in time", kAtOnce,
     "look at the states of the components and at the drives"},
    {F::EmergencyStop, "emergency_stop", "emergency stop", kWhenGone, "release the emergency stop"},
    {F::GuardianActed, "guardian_acted", "the guardian found the controller silent and took its outputs away",
     kWhenGone, "look for what stopped the controller; resetting asks the guardian for the outputs"},
    {F::NotReset, "not_reset", "the controller has just started and nobody has reset it yet", kWhenGone,
     "look at the robot, then reset"},
    {F::HandSwitch, "hand_switch", "the patient's hand switch", kWhenGone,
     "ask the patient; the switch has to be in its rest position and plugged in"},
    {F::SoftLimit, "soft_limit", "the axis moves beyond its soft limit", kAtOnce,
     "look why the reference or the platform went there; move it back by hand with the drives off"},
    {F::VelocityLimit, "velocity_limit", "the axis is faster than its velocity limit", kAtOnce,
     "look for a reference that is too fast, gains that are too high, a push from outside"},
    {F::AccelerationLimit, "acceleration_limit", "the axis accelerates beyond its limit", kAtOnce,
     "look for a collision, gains that are too high, a loose encoder"},
    {F::Stalled, "stalled", "the drive pushes and the axis stands still", kAtOnce,
     "look for an obstacle, a brake that did not open, a drive without power"},
    {F::Runaway, "runaway",
     "the axis runs away from its reference against the force: a wrong sign, a drive without power, or a push that is "
     "stronger",
     kAtOnce,
     "check the drive's supply, encoder_sign and force_sign in the robot file, the wiring of motor and encoder"},
    {F::EncoderFrozen, "encoder_frozen",
     "the encoder does not count although the axis is driven: it is dead, or the axis is blocked", kAtOnce,
     "check the encoder's cable and coupling, then look for an obstacle or a brake that did not open"},
    {F::EncoderJump, "encoder_jump", "the encoder jumped farther than the axis can move in one cycle", kAtOnce,
     "check the encoder's cable and shield; home again before moving"},
    {F::Saturated, "saturated", "the force was at its limit for too long", kAtOnce,
     "look for an obstacle, a load that is too heavy, a reference that is too fast"},
    {F::ThermalOverload, "thermal_overload", "the motor got more than its continuous force for too long (I2t)",
     kWhenGone, "let the motor cool down, then reset; lighten the load"},
    {F::PatientPose, "patient_pose", "the platform left the range that the patient file allows", kAtOnce,
     "bring the platform back by hand with the drives off, or correct the patient file"},
    {F::PatientSpeed, "patient_speed", "the platform was faster than the patient file allows", kAtOnce,
     "play at a lower speed, or correct the patient file"},
    {F::HomingFailed, "homing_failed", "the axis did not find its home within the distance and time allowed", kAtOnce,
     "look at the switch or the stop, the direction and the force in the hardware file, then home again"},
    {F::BusDown, "bus_down", "the CAN interface is down or gone", kWhenGone,
     "check adapter and cable, bring the interface up, then restart the controller if the drives lost their power"},
    {F::BusOff, "bus_off", "the CAN controller has left the bus after too many errors", kWhenGone,
     "check cable, termination and bit rate; ip link set with restart-ms brings it back"},
    {F::BusFlooded, "bus_flooded", "the CAN bus carries more frames than it should", kWhenGone,
     "look with candump for what sends them"},
    {F::DriveLost, "drive_lost", "the drive sends no feedback, or has restarted", kWhenGone,
     "check the drive's power and cable; a drive that has restarted needs a restart of the controller"},
    {F::FeedbackLate, "feedback_late", "the drive's feedback came late, twice or out of order", kAtOnce,
     "look for what delays the bus or the controller: other traffic, the adapter, the machine"},
    {F::DriveHeartbeatLost, "drive_heartbeat_lost", "the drive's heartbeat stays away", kWhenGone,
     "check the drive's power and cable"},
    {F::ControllerHeartbeatLost, "controller_heartbeat_lost",
     "the drive missed the controller's heartbeat and stopped by itself", kWhenGone,
     "look for what stopped the controller or its frames for so long"},
    {F::DriveEmergency, "drive_emergency", "the drive has sent an emergency", kWhenGone,
     "look up the drive's error code"},
    {F::DriveFault, "drive_fault", "the drive is in fault", kWhenGone,
     "look up the drive's error code; resetting also resets the drive"},
    {F::DriveNotEnabled, "drive_not_enabled", "the drive left Operation Enabled or did not reach it", kWhenGone,
     "look at the drive's enable input, power and settings"},
    {F::MonitorsStale, "monitors_stale", "the monitors gave no verdict", kWhenGone,
     "look at the state and the timing of the component Monitors and at the deployment's connections"},
}};

}  // namespace

const FaultDescription& describe(Fault fault) noexcept {
  return kTable[static_cast<std::size_t>(fault)];
}

bool concernsAllAxes(Fault fault) noexcept {
  return fault == Fault::PatientPose || fault == Fault::PatientSpeed || fault == Fault::SetPointStale;
}

bool closesLoop(Fault fault) noexcept {
  switch (fault) {
    case Fault::NotANumber:
    case Fault::FollowingError:
    case Fault::SetPointJump:
    case Fault::MeasurementLost:
    case Fault::CommandStale:
    case Fault::Runaway:
    case Fault::AccelerationLimit:  // a loop that shakes itself must not go on
    case Fault::EncoderFrozen:
    case Fault::EncoderJump:
      return false;
    default:
      return true;
  }
}

}  // namespace knee_robot::control
