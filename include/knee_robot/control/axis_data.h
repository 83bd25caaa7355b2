#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/control/faults.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/rt/cycle.h"

/// What travels between the real-time components: plain structures, copied through ports. SI units; time in ns of the
/// deployment's clock; arrays are per actuator, legs 1 to 4.
namespace knee_robot::control {

using hardware::kAxes;
using AxisValues = std::array<double, hardware::kAxes>;

/// AxesInput, once a servo cycle.
struct AxesMeasurement {
  std::uint64_t sequence = 0;   ///< counts executed cycles
  rt::Nanoseconds time = 0;     ///< planned time of the cycle: what all components of the cycle calculate with
  rt::Nanoseconds read_at = 0;  ///< when the counters were latched
  hardware::IoStatus status = hardware::IoStatus::NotReady;  ///< unless Ok, what follows is that of the last good cycle
  AxisValues position_m{};
  AxisValues velocity_m_per_s{};  ///< low-passed difference
  std::array<std::int64_t, hardware::kAxes> counts{};
  std::uint8_t digital_inputs = 0;
  std::uint32_t home_number = 0;     ///< of the last HomeSetting
  bool fenced_out = false;           ///< a guardian has taken the outputs
  bool guardian_carries = false;     ///< and lets the drives carry the load
  hardware::BusFailure bus_failure;  ///< what a bus of drives tells beyond `status`
};

/// What Sync is doing.
enum class SyncPhase : std::uint8_t {
  Idle,      ///< nothing played since the Drivers took over: they hold where they are
  Playing,   ///< path time runs
  Stopping,  ///< path time is being slowed down to zero, for good
  Holding,   ///< at rest on the path: at its end, or where it was stopped
  Paused,    ///< at rest on the path, which goes on as soon as pause and speed allow
};

/// Why Sync did not start to play.
enum class PlayRefusal : std::uint8_t { None, NoReference, NotAtStart, NotReady };

/// Sync, every 10 ms: the segment that the Drivers interpolate until the next one comes. A Driver's reference position
/// runs linearly from `from` to `to` (so it never leaves what the reference check has seen), its reference velocity
/// from `from_velocity` to `to_velocity` (central differences, for the derivative term).
struct SetPoint {
  std::uint64_t sequence = 0;  ///< counts all set points, idle ones too
  std::uint32_t run = 0;       ///< number of the play request that this belongs to
  SyncPhase phase = SyncPhase::Idle;
  rt::Nanoseconds start = 0;
  rt::Nanoseconds duration = 0;
  AxisValues from_m{};
  AxisValues to_m{};
  AxisValues from_velocity{};  ///< m/s
  AxisValues to_velocity{};    ///< m/s
  double path_time_s = 0.0;    ///< at `start`
  double path_duration_s = 0.0;
  double time_scale = 0.0;        ///< speed of path time at `start`, 0 to 1
  std::uint32_t refused_run = 0;  ///< last play request that was refused
  PlayRefusal refusal = PlayRefusal::None;
  int refused_axis = 0;  ///< 1 to 4, for NotAtStart
  double refused_distance_m = 0.0;
};

/// Where an axis is in its homing.
enum class HomingPhase : std::uint8_t { Idle, Searching, BackingOff, Found, Failed };

/// Supervisor to AxesInput: a new number shifts the lengths of the axes, once. Only while the drives are off.
struct HomeSetting {
  std::uint32_t number = 0;
  AxisValues shift_m{};
};

/// ModelFeedforward, every servo cycle: what the model says that the axes carry.
struct FeedforwardForce {
  std::uint64_t sequence = 0;
  rt::Nanoseconds time = 0;
  AxisValues force_N{};
  AxisValues moving_N{};     ///< the part of force_N for inertia and friction: gone when the axes rest
  AxisValues switched_N{};   ///< sum of all changes of force_N that are no change of the load, ever since the start
  AxisValues weight_N{};     ///< all that the model weighs here, whatever share of it is in force_N; 0: not known
  AxisValues declared_N{};   ///< sum of all changes of weight_N that are no change of the load, ever since the start
  AxisValues per_kg_N{};     ///< of a point mass at the platform's origin, here; 0: not known
  AxisValues loop_N{};       ///< besides: feedback through the model (ControlLaw)
  bool closes_loop = false;  ///< loop_N takes the place of the Drivers' proportional and derivative terms
  double payload_kg = 0.0;   ///< declared
  bool complete = false;     ///< the whole force is there: the holding brakes may be released
};

/// One Driver, once its period.
struct AxisCommand {
  std::uint64_t sequence = 0;  ///< of the measurement that it answers
  rt::Nanoseconds time = 0;    ///< of that cycle
  int axis = 0;                ///< 1 to 4: a command on the wrong wire is refused
  bool active = false;         ///< the position loop is closed
  bool loaded = true;          ///< the feedforward, where there is one, is complete
  bool at_rest = false;        ///< the reference stands still
  Fault fault = Fault::None;  ///< of this axis; with loopStaysClosed(fault) the volts are still those of a working loop
  double volts = 0.0;
  double force_N = 0.0;        ///< what the volts ask for
  double feedforward_N = 0.0;  ///< the part of it that a model foresaw
  double moving_N = 0.0;       ///< the part of that which is for the motion: gone when the axis rests
  double weight_N = 0.0;       ///< all that a model weighs at this place, foreseen or not; 0: not known
  double declared_N = 0.0;     ///< sum of the changes of weight_N that are no change of the load
  double per_kg_N = 0.0;       ///< of a point mass at the platform's origin, here; 0: not known
  double reference_m = 0.0;
  double reference_velocity = 0.0;  ///< m/s
  bool homed = false;               ///< as ordered: the lengths mean something
  double pulse_N = 0.0;             ///< the part of force_N that asks whether the encoder counts
  bool can_be_asked = false;        ///< this Driver asks when a monitor wants to know
  std::uint32_t answers = 0;        ///< how often the encoder has answered
  HomingPhase homing = HomingPhase::Idle;
  double home_m = 0.0;  ///< measured where home was found; BackingOff and Found
};

/// Monitors, every servo cycle.
struct MonitorVerdict {
  std::uint64_t sequence = 0;  ///< of the measurement that it evaluates
  rt::Nanoseconds time = 0;
  std::array<Fault, hardware::kAxes>
      fault{};  ///< kept until the Drivers are switched off; those of the whole platform are at axis 1
  std::array<bool, hardware::kAxes> asks{};  ///< the encoder looks dead: the Driver tests it before a fault is raised
  AxisValues heat{};                         ///< I2t: 0 cold, 1 the fault
};

/// Whether the other axes have moved with a test pulse (PulseWitness).
enum class Felt : std::uint8_t { Unknown, No, Yes };

/// DisturbanceObserver, every servo cycle: what acts on the robot that nobody commanded. Meanings:
/// residual_estimator.h, disturbance_classifier.h.
struct Disturbance {
  std::uint64_t sequence = 0;  ///< of the measurement that it is calculated from
  rt::Nanoseconds time = 0;
  std::uint32_t suspicion = 0;  ///< a new number: something disturbs the standing robot, the encoders are to be asked
  std::uint32_t questions =
      0;  ///< a new number: nothing has counted for long, the encoder of axis `asked` (from 0) is to be asked
  int asked = -1;
  std::array<Felt, hardware::kAxes> felt{};  ///< of the last test pulse of each axis
  bool identified =
      false;           ///< by a model that says how good it is; else by the URDF's weights, and nothing is evaluated
  bool known = false;  ///< the Drivers carry and what follows is calculated
  AxisValues expected_N{}, residual_N{}, certain_N{}, rms_N{}, band_N{};
  std::array<double, 4> wrench{};       ///< on the platform, coordinates Xm, Zm (N), theta, psi (N m)
  std::array<double, 4> wrench_band{};  ///< what the bands of the legs can look like
  std::array<double, 4> pose{};         ///< of the platform
  bool pushed = false;
  std::array<double, 4> push{};  ///< the part of the wrench that is no load
  bool carries = false;
  double load_kg = 0.0, load_m = 0.0;
  std::array<bool, hardware::kAxes> friction_changed{};
  AxisValues friction_growth{}, friction_least{};  ///< as DisturbanceClassifier::Verdict says
  bool model_holds = true;
};

/// Why hand guiding is impossible, or ended by itself.
enum class GuideStop : std::uint8_t {
  None,
  NoModel,       ///< no identified model
  UnknownLoad,   ///< something that nobody declared rests on the platform
  OutsideRange,  ///< the platform is where it must not be guided
  Wall,          ///< pressed too far into a virtual wall
  TooFast,       ///< faster than allowed in spite of the brake
  LostPose,      ///< no pose, or NaN
  PathFull,      ///< the record of the path is full
  Silent,        ///< HandGuide says nothing any more
};

/// HandGuide, every servo cycle: what the Drivers give in place of their loops while a hand moves the platform.
struct Guidance {
  std::uint64_t sequence = 0;
  rt::Nanoseconds time = 0;
  bool active = false;          ///< force_N takes the place of the Drivers' loops, which keep what they carried
  AxisValues force_N{};         ///< to be added in any case; the weight is ModelFeedforward's
  std::uint32_t suspicion = 0;  ///< a new number: the encoders of `doubted` are to be asked
  std::array<bool, hardware::kAxes> doubted{};
  GuideStop stop = GuideStop::None;  ///< why guiding cannot begin now, or has to end
};

/// How far the drives are switched on. Going up one by one, down only through the safe stop.
enum class DriveLevel : std::uint8_t {
  Off,            ///< holding brake engaged, drive disabled, 0 V
  Energised,      ///< drive enabled at 0 V, holding brake still engaged
  HeldByDrivers,  ///< Drivers hold at the measured position, holding brake still engaged
  Released,       ///< holding brake released: the Drivers alone carry the platform
};

/// Supervisor, every servo cycle.
struct SupervisorCommand {
  std::uint64_t sequence = 0;
  rt::Nanoseconds time = 0;
  DriveLevel level = DriveLevel::Off;
  bool immediate = false;       ///< safe stop without deceleration: drive power is gone
  bool safe_stop = false;       ///< run the safe stop (again true: no effect)
  bool drivers_active = false;  ///< Drivers close their loops
  std::uint32_t play = 0;       ///< a new number asks Sync to play from the start
  bool stop_path = false;       ///< Sync slows path time down to zero and gives the path up
  bool pause_path = false;      ///< Sync slows path time down to zero and keeps the path
  double speed = 1.0;           ///< 0 to 1: time scale that Sync approaches without a jump
  AxisValues brake_test_N{};    ///< while Energised: pushed against the engaged holding brakes
  std::uint32_t transfer = 0;   ///< a new number: a safe stop that is Carrying tries to hand over the load again
  bool homed = false;           ///< all axes know where they are: soft limits and the patient's range hold
  std::uint8_t homing = 0;      ///< bit i: the Driver of axis i + 1 looks for home; the others hold
  bool seeks_home = false;      ///< the axes are being homed: no length means anything, but each encoder has to count
  bool guiding = false;         ///< a hand moves the platform (HandGuide): the Drivers carry, they do not hold
  bool slows_down = false;      ///< a safe stop runs, the holding brakes are open and the encoders can be asked
  bool holds_here = false;      ///< AxesWritten::holds_here: the Drivers hold where they are and follow no path

  /// The holding brakes are open, or just opening: the Drivers alone carry the platform.
  bool driversCarry() const noexcept { return level == DriveLevel::Released && (!safe_stop || slows_down); }
};

/// Where the safe stop is.
enum class SafeStopPhase : std::uint8_t {
  Idle,
  Decelerating,
  Settling,
  Engaging,
  Transferring,  ///< the force goes down while the positions are watched
  Carrying,      ///< a holding brake slipped: the drives carry on
  Disabling,
  Done,
};

/// The loops still carry the platform along, the holding brakes are open: what watches a motion goes on watching.
constexpr bool slowsDown(SafeStopPhase phase) noexcept {
  return phase == SafeStopPhase::Decelerating || phase == SafeStopPhase::Settling;
}

/// AxesOutput, every servo cycle.
struct AxesWritten {
  std::uint64_t sequence = 0;  ///< of the measurement of the same cycle
  rt::Nanoseconds time = 0;
  hardware::IoStatus status = hardware::IoStatus::NotReady;
  DriveLevel level = DriveLevel::Off;
  SafeStopPhase safe_stop = SafeStopPhase::Idle;
  Fault fault = Fault::None;     ///< why AxesOutput itself began the safe stop
  int fault_axis = 0;            ///< 1 to 4, 0: none in particular
  std::uint32_t safe_stops = 0;  ///< completed since the start
  std::uint32_t transfer = 0;    ///< Supervisor's number that was heard last
  bool holds_here = false;       ///< the brakes should hold, and what is left of the loops has to hold there
  bool unordered = false;        ///< brakes and drives can be ordered nothing any more: the output card is gone
  std::uint8_t digital_outputs = 0;
  AxisValues volts{};    ///< as the converter got them, after clamp and quantization
  AxisValues force_N{};  ///< that these volts ask for
};

/// Recorder, every servo cycle: a row of the recording, and what is published.
struct TrackingRow {
  std::uint64_t sequence = 0;     ///< of the measurement; a gap in a recording is a dropped row
  std::uint32_t recording = 0;    ///< number of the recording that it belongs to, 0: none
  std::uint32_t home_number = 0;  ///< changes whenever the axes are homed anew
  std::int64_t cycle = 0;         ///< planned time in servo periods; a gap is a cycle that the machine skipped
  double time_s = 0.0;            ///< when the position was read
  AxisValues reference_m{};
  AxisValues position_m{};
  AxisValues velocity_m_per_s{};
  AxisValues command_V{};
  AxisValues force_N{};
  AxisValues feedforward_N{};  ///< the part of it that a model foresaw; not in recordings
  AxisValues residual_N{};     ///< Disturbance::residual_N
  bool residual_known = false;
  double path_time_s = 0.0;
  std::uint8_t test_pulse = 0;  ///< bit i: the encoder of axis i + 1 is being asked whether it counts
  std::uint8_t digital_inputs = 0;
  std::uint8_t digital_outputs = 0;
};

}  // namespace knee_robot::control
