#include "knee_robot/control/faults.h"

#include <array>

namespace knee_robot::control {
namespace {

using F = Fault;
constexpr ResetRule kAtOnce = ResetRule::OnRequest;
constexpr ResetRule kWhenGone = ResetRule::WhenCauseIsGone;
constexpr Loop kWorks = Loop::Works;
constexpr Loop kLost = Loop::Lost;  // an oscillating loop counts as lost, too
constexpr StopCategory kNoStop = StopCategory::None;
constexpr StopCategory kZero = StopCategory::Zero;
constexpr StopCategory kOne = StopCategory::One;
constexpr StopCategory kByGuardian = StopCategory::ByGuardian;

constexpr std::array<FaultDescription, kFaults> kTable = {{
    {F::None, "none", "no fault", kAtOnce, kWorks, kNoStop, ""},
    {F::MeasurementLost, "measurement_lost", "the encoders could not be read", kWhenGone, kLost, kOne,
     "check the counter card and its cable; a card that was gone has lost its counts: restart the controller and home "
     "again"},
    {F::OutputLost, "output_lost", "the outputs could not be written", kWhenGone, kWorks, kOne,
     "check the analog and the digital outputs; after a counter card was gone, restart the controller and home again"},
    {F::NotANumber, "not_a_number", "a reference, a measurement or a command was not a number", kAtOnce, kLost, kOne,
     "find out where it came from: this is a fault of the program or of its data"},
    {F::FollowingError, "following_error", "the axis did not follow its reference", kAtOnce, kLost, kOne,
     "look for an obstacle, a brake that did not open, a reference that is too fast, a wrong sign"},
    {F::SetPointStale, "set_point_stale", "a set point of Sync came too late, or not at all", kWhenGone, kWorks, kOne,
     "look at the state and the timing of Sync"},
    {F::SetPointJump, "set_point_jump", "the set point jumped", kAtOnce, kLost, kOne, "load the reference again"},
    {F::CommandStale, "command_stale", "no new command came from the axis' Driver", kWhenGone, kLost, kOne,
     "look at the state and the timing of the Driver and at the deployment's connections"},
    {F::OrdersStale, "orders_stale", "no new orders came from the Supervisor", kWhenGone, kWorks, kOne,
     "look at the state and the timing of the Supervisor"},
    {F::PositionOutOfRange, "position_out_of_range", "the axis left its range", kAtOnce, kWorks, kOne,
     "move it back by hand with the drives off, check the home position"},
    {F::ComponentException, "component_exception", "a component failed with an exception", kWhenGone, kWorks, kOne,
     "resetting recovers the component"},
    {F::ComponentFatal, "component_fatal", "a component failed for good", ResetRule::Restart, kWorks, kOne,
     "restart the controller"},
    {F::ComponentStopped, "component_stopped", "a component that is needed does not run", kWhenGone, kWorks, kOne,
     "resetting starts the component again"},
    {F::Overrun, "overrun", "the servo cycle was late too many times in a row", kAtOnce, kWorks, kOne,
     "look for what takes the processor: the deployment's priorities, other programs, the machine"},
    {F::EnableTimeout, "enable_timeout", "the drives could not be enabled in time", kAtOnce, kWorks, kOne,
     "look at the states of the components and at the drives"},
    {F::EmergencyStop, "emergency_stop", "emergency stop", kWhenGone, kWorks, kZero, "release the emergency stop"},
    {F::GuardianActed, "guardian_acted", "the guardian found the controller silent and took over its outputs",
     kWhenGone, kWorks, kByGuardian,
     "look for what stopped the controller; resetting asks the guardian for the outputs"},
    {F::NotReset, "not_reset", "the controller has just started and nobody has reset it yet", kWhenGone, kWorks, kOne,
     "look at the robot, then reset"},
    {F::HandSwitch, "hand_switch", "the patient's hand switch", kWhenGone, kWorks, kOne,
     "ask the patient; the switch has to be in its rest position and plugged in"},
    {F::SoftLimit, "soft_limit", "the axis moves beyond its soft limit", kAtOnce, kWorks, kOne,
     "look why the reference or the platform went there; move it back by hand with the drives off"},
    {F::VelocityLimit, "velocity_limit", "the axis is faster than its velocity limit", kAtOnce, kWorks, kOne,
     "look for a reference that is too fast, gains that are too high, a push from outside"},
    {F::AccelerationLimit, "acceleration_limit", "the axis accelerates beyond its limit", kAtOnce, kLost, kOne,
     "look for a collision, gains that are too high, a loose encoder"},
    {F::Stalled, "stalled", "the drive pushes and the axis stands still", kAtOnce, kWorks, kOne,
     "look for an obstacle, a brake that did not open, a drive without power"},
    {F::Runaway, "runaway",
     "the axis runs away from its reference against the force: a wrong sign, a drive without power, or a push that is "
     "stronger",
     kAtOnce, kLost, kOne,
     "check the drive's supply and the wiring of motor and encoder; then encoder_sign by hand, with the drives off; "
     "then force_sign (with both wrong the leg goes the other way)"},
    {F::EncoderFrozen, "encoder_frozen",
     "the encoder does not count although the axis is driven: it is dead, or the axis is blocked", kAtOnce, kLost, kOne,
     "check the encoder's cable and coupling, then look for an obstacle, a brake that did not open, a drive without "
     "power; home again before moving"},
    {F::EncoderJump, "encoder_jump",
     "the encoder jumped farther than the axis can move, or goes to and fro faster than it can", kAtOnce, kLost, kOne,
     "check the encoder's cable and shield; home again before moving"},
    {F::Saturated, "saturated", "the force was at its limit for too long", kAtOnce, kWorks, kOne,
     "look for an obstacle, a load that is too heavy, a reference that is too fast"},
    {F::ThermalOverload, "thermal_overload", "the motor got more than its continuous force for too long (I2t)",
     kWhenGone, kWorks, kOne, "let the motor cool down, then reset; lighten the load"},
    {F::PatientPose, "patient_pose", "the platform left the range that the patient file allows", kAtOnce, kWorks, kOne,
     "bring the platform back by hand with the drives off, or correct the patient file"},
    {F::PatientSpeed, "patient_speed", "the platform was faster than the patient file allows, or shook", kAtOnce,
     kWorks, kOne,
     "play at a lower speed, or correct the patient file; where it shook, ask the patient, then look at the gains"},
    {F::HomingFailed, "homing_failed", "the axis did not find its home within the distance and time allowed", kAtOnce,
     kWorks, kOne,
     "look at the switch (open as long as no axis stands on its own) or the stop, the direction and the force in the "
     "hardware file, then home again"},
    {F::BusDown, "bus_down", "the CAN interface is down or gone", kWhenGone, kLost, kOne,
     "check adapter and cable, bring the interface up, then restart the controller if the drives lost their power"},
    {F::BusOff, "bus_off", "the CAN controller has left the bus after too many errors", kWhenGone, kLost, kOne,
     "check cable, termination and bit rate; ip link set with restart-ms brings it back"},
    {F::BusFlooded, "bus_flooded", "the CAN bus carries more frames than it should", kWhenGone, kWorks, kOne,
     "look with candump for what sends them"},
    {F::DriveLost, "drive_lost", "the drive sends no feedback, or has restarted", kWhenGone, kLost, kOne,
     "check the drive's power and cable; a drive that has restarted needs a restart of the controller"},
    {F::FeedbackLate, "feedback_late", "the drive's feedback came late, twice, out of order or too seldom", kAtOnce,
     kWorks, kOne,
     "look for what delays the bus or the controller: other traffic, the adapter, the machine; for a second drive with "
     "its "
     "node number, and for a second controller"},
    {F::DriveHeartbeatLost, "drive_heartbeat_lost", "the drive's heartbeat stays away", kWhenGone, kWorks, kOne,
     "check the drive's power and cable"},
    {F::ControllerHeartbeatLost, "controller_heartbeat_lost",
     "the drive missed the controller's heartbeat and stopped by itself", kWhenGone, kLost, kOne,
     "look for what stopped the controller or its frames for so long"},
    {F::DriveEmergency, "drive_emergency", "the drive has sent an emergency", kWhenGone, kWorks, kOne,
     "look up the drive's error code"},
    {F::DriveFault, "drive_fault", "the drive is in fault", kWhenGone, kLost, kOne,
     "look up the drive's error code; resetting also resets the drive"},
    {F::DriveNotEnabled, "drive_not_enabled", "the drive left Operation Enabled or did not reach it", kWhenGone, kLost,
     kOne, "look at the drive's enable input, power and settings"},
    {F::MonitorsStale, "monitors_stale", "the monitors gave no verdict, or could not judge the force on the patient",
     kWhenGone, kWorks, kOne,
     "look at the state and the timing of Monitors and DisturbanceObserver and at the deployment's connections; if "
     "both "
     "run, use a model without the effects of trace"},
    {F::GuardianSilent, "guardian_silent",
     "the guardian is silent: nothing would switch the outputs off if this controller died", kWhenGone, kWorks, kOne,
     "look for what stopped the guardian, start it again, then reset; where that does not help, end both and "
     "start both"},
    {F::HoldDeviceSlips, "hold_device_slips",
     "the holding brake does not hold its axis; the drives do while the robot is "
     "safe_stopping",
     kWhenGone, kWorks, kOne,
     "get the patient off and support the platform before you disable again; then mend the brake"},
    {F::InputsStale, "inputs_stale",
     "the drive that reads emergency stop and hand switch does not report them any more", kWhenGone, kWorks, kOne,
     "check that drive's power, cable and PDO 2"},
    {F::DriveTorque, "drive_torque", "the drive reports a torque other than the commanded one", kAtOnce, kLost, kOne,
     "check the drive's limits and settings, its motor cable and the motor"},
    {F::PatientForce, "patient_force",
     "the platform presses harder than the patient file allows, or somebody presses against it", kAtOnce, kWorks, kOne,
     "ask the patient; look what the platform touches; declare the weight that it carries (payload_kg)"},
    {F::AxisBlocked, "axis_blocked",
     "the axis does not move although it is driven, and the other axes do not feel it: it is blocked, or its drive "
     "gives no force",
     kAtOnce, kLost, kOne,
     "look for a brake that did not open, an obstacle, a drive without power; then check the encoder's cable and "
     "coupling, and home again"},
    {F::DriveStaysOn, "drive_stays_on", "the drive says that it is on although it was switched off", kWhenGone, kLost,
     kOne, "keep away and take its supply; then check its enable input and bus cable, and restart the controller"},
    {F::DrivesNotReady, "drives_not_ready", "a drive is not ready: it has lost its supply, or is in fault", kAtOnce,
     kLost, kOne, "look which drive's ready contact is open, at its supply and at the fault that it shows"},
    {F::MovedWhileOff, "moved_while_off",
     "the axis has moved although the drives are off and its holding brake should hold it", kWhenGone, kWorks, kOne,
     "get the patient off and support the platform, then look at the brake; where somebody has moved the platform by "
     "hand, reset"},
    {F::WeightOpposite, "weight_opposite", "the axis carries the opposite of what it should weigh", kAtOnce, kWorks,
     kOne,
     "move nothing: turn the screw by hand with the drives off and see whether its length grows as the leg does "
     "(encoder_sign; where that is wrong, so is force_sign); then check gravity in the robot file, the model, and "
     "whether somebody lifts the platform"},
}};

constexpr bool isInOrder() {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (kTable[i].fault != static_cast<Fault>(i)) return false;
  }
  return true;
}
static_assert(isInOrder(), "a row for every Fault, in the order of their numbers, and kFaults of them");

}  // namespace

const FaultDescription& describe(Fault fault) noexcept {
  return kTable[static_cast<std::size_t>(fault)];
}

bool takesTheMachine(Fault fault) noexcept {
  const StopCategory stop = describe(fault).stop;
  return stop == StopCategory::Zero || stop == StopCategory::ByGuardian;
}

bool concernsAllAxes(Fault fault) noexcept {
  return fault == Fault::PatientPose || fault == Fault::PatientSpeed || fault == Fault::PatientForce ||
         fault == Fault::SetPointStale || fault == Fault::MonitorsStale;
}

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
    case hardware::BusFault::DriveStaysOn:
      return Fault::DriveStaysOn;
    case hardware::BusFault::GuardianSilent:
      return Fault::GuardianSilent;
  }
  return Fault::None;
}

bool loopStaysClosed(Fault fault) noexcept {
  return describe(fault).loop == Loop::Works;
}

}  // namespace knee_robot::control
