#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/control_status.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/path_expectation.h"
#include "knee_robot/control/playable_reference.h"
#include "knee_robot/control/wishes_so_far.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/deployer.h"
#include "knee_robot/rt/property.h"
#include "knee_robot/rt/statistics_report.h"

namespace knee_robot::control {

struct ControllerParts;

/// The whole controller: components from a deployment file on a robot, a hardware file and an axis bus, and the
/// operator's commands. No ROS. Functions may be called from several ordinary threads; none is real-time. Commands wait
/// for the machine's answer: enable() and disable() until it is done, play(), approach() and stop() until it has begun.
/// A façade: each command is that of one of the parts in src/control, which docs/architecture.md names.
///
/// Stepped execution: commands execute as many cycles as their answer takes, through step(), so the plant moves on too.
class ControlSystem {
 public:
  /// What a program may choose beyond the deployment file.
  struct Options {
    rt::Execution execution = rt::Execution::Threads;
    /// Actuator lengths at which the robot stands when start() resets the counters; default: the robot file's home
    /// lengths.
    std::optional<AxisValues> lengths_at_start_m;
    /// Component types added to, or put in place of, the usual ones: for fault injection and new components.
    rt::TypeFactory types;
    /// Model file and payload (kg, 0 to 50) of ModelFeedforward, in place of the deployment's.
    std::string model;
    std::optional<double> payload_kg;
    /// Processor of all activities, in place of the deployment's; -1: any.
    std::optional<int> cpu;
    /// Where the last 5 s of all signals go on every fault (BlackBoxWriter); empty: nowhere.
    std::string black_box_folder;
    /// Where the motors' heat is kept from one start to the next (HeatMemory); empty: nowhere, they start cold.
    std::string heat_file;
    /// Where the loaded patient is remembered from one start to the next (PatientMemory); empty: nowhere.
    std::string patient_memory;
    /// Somebody declares that nobody is on the robot. A remembered patient wins.
    bool empty = false;
  };

  /// Reads the deployment, makes and connects everything; nothing runs. Throws InputError. `bus` must outlive this.
  ControlSystem(const mechanism::Robot& robot, const HardwareFile& hardware, const std::string& deployment_path,
                hardware::AxisBus& bus, Options options);
  /// shutdown().
  ~ControlSystem();

  /// Self test of the bus (drives off, holding brakes engaged), then all components are started. Ends in Disabled, or
  /// Faulted where a fault is there from the beginning (an emergency stop that is pressed): ok, but the sentence says
  /// so.
  Answer start();
  /// Safe stop if anything moves or holds, recording closed, components stopped in reverse. Can not be undone. Refused
  /// while the drives carry the platform because a holding brake slipped: support it, then try again (the destructor
  /// does not ask).
  Answer shutdown();
  /// From now on nothing is switched on or moved any more; stops go on being obeyed. For a process that is about to
  /// end.
  void refuseToMove();
  /// AxesOutput has the drives off, or has never said anything.
  bool outputsAreOff() const;
  /// Only the drives carry the platform, until somebody supports it: a holding brake slipped, or the brakes cannot be
  /// ordered.
  bool drivesCarry() const;

  /// Refused unless a patient is loaded or nobody is on the robot, explicitly.
  /// `halts`, here and below: halts() when it was asked for (default: now). Whoever stops the robot after that wins,
  /// even where the answer comes later.
  /// Disabled -> Holding: 0 V, drives enabled, Drivers take over at the measured position, holding brakes released.
  Answer enable(std::optional<std::uint64_t> halts = {});
  /// Holding, Playing -> Disabled by the safe stop.
  Answer disable();
  /// Checks the reference against the robot (everything that check_reference checks). InputError: the first limit that
  /// it breaks.
  PlayableReference check(trajectory::Reference reference) const;
  /// Why the loaded patient's limits forbid it; empty: they do not, or no patient is loaded.
  std::string whyNotForPatient(const PlayableReference& playable) const;
  /// Hands over what check() of this let pass, once more only against the patient's limits, who may have changed. Not
  /// while playing.
  Answer loadReference(const PlayableReference& playable);
  /// The same with check() before it.
  Answer loadReference(const trajectory::Reference& reference);
  /// Reads a patient file (patient_limits.h) and holds the machine to it from now on: references and approaches are
  /// checked against it on loading and playing, pose and speed are monitored during motion. Refused with every reason
  /// why no patient may be on this machine (docs/safety.md; with the simulated backend they are only told). Only while
  /// Disabled; forgets the loaded reference.
  Answer loadPatient(const std::string& path);
  /// The patient has left, and who is on the robot now has to be declared before anything moves. Only while Disabled.
  Answer clearPatient();
  /// Nobody is on the robot: only its own limits hold. Only while Disabled.
  Answer declareEmpty();
  /// Plays the loaded reference from its first point; refused unless the robot stands there, and what is `expected` is
  /// still so.
  Answer play(const PathExpectation& expected = {});
  /// Plays a slow straight approach (actuator space, rest to rest) from the measured position to the first point of the
  /// loaded reference, checked like any reference. Follow it by waiting for Holding and play().
  Answer approach(double speed_m_per_s = 0.01, const PathExpectation& expected = {});
  /// Slows down along the path, then holds. Answers when it has begun. Like disable() and emergencyStop() it also ends
  /// what was asked for before and has not begun yet (halts()).
  Answer stop();
  /// The same for whoever ends nothing but the path that it began itself.
  Answer stopPath();
  /// How often somebody wanted the robot to stand, in whatever state it was: stop(), disable(), emergencyStop().
  std::uint64_t halts() const;
  /// The same, with pauses and speeds.
  WishesSoFar wishesSoFar() const;
  /// Slows path time down to zero (state Paused when at rest), and back to what setSpeed() asked for: no jump, the
  /// robot never leaves its path, wherever on it and however often. Answer when it has begun. Also during an approach.
  /// `since`: of when resume() was asked for (default: now). Whoever stops or pauses the robot after that wins.
  Answer pause();
  Answer resume(std::optional<WishesSoFar> since = {});
  /// Speed of path time, 0 to 100 % of what the reference asks for; holds for all paths until it is set anew. Takes
  /// effect at once and without a jump while playing; 0 is Paused until another speed comes. Refused outside 0 to 100,
  /// and what is not a number.
  Answer setSpeed(double percent);
  /// The same for whoever sets the speed of a path that it begins itself.
  Answer setPathSpeed(double percent);
  /// Finds home by the procedure of the hardware file (`homing:`), from Disabled: the axes move slowly one after the
  /// other (state Homing), and the machine ends Disabled with `homed`, or Faulted with homing_failed. Answers when it
  /// has begun. Where the method is hand_placed or assumed, nothing moves and the sentence says what to do.
  Answer home(std::optional<std::uint64_t> halts = {});
  /// Method hand_placed: the robot stands at its home lengths now, says the operator; only in Disabled.
  Answer confirmHome();
  /// A hand moves the platform from now on, as long as the enabling switch is held (docs/guiding.md): Holding ->
  /// Guiding -> Holding.
  /// Refused without such a switch, an identified model, tested brakes, or where the platform must not be guided.
  Answer guide(std::optional<std::uint64_t> halts = {});
  /// The path that was guided last as a reference file that may be played: smoothed, as slow as the limits want it,
  /// checked.
  SavedReference saveGuided(const std::string& path);
  /// Safe stop now, latched like a fault until resetFaults().
  Answer emergencyStop();
  /// Recovers failed components and clears the latched fault; ends in Disabled.
  Answer resetFaults();

  /// A row per servo cycle into a new file; refused when it exists.
  Answer startRecording(const std::string& path);
  /// Closes the file; not ok when rows were dropped or the disk refused, with the number. `only`: that recording or
  /// none, for whoever began it; not ok when somebody else has ended it.
  Answer stopRecording(const std::string& only = "");

  ControlStatus status() const;
  MachineState state() const { return status().state; }
  /// Newest row; lock-free towards the real-time side. Empty before the first cycle.
  std::optional<TrackingRow> snapshot() const;
  /// Newest residual and what it says (noticesOf()); lock-free towards the real-time side. Empty before the first
  /// cycle, and without a DisturbanceObserver.
  std::optional<Disturbance> disturbance() const;
  /// Waits (threads) or executes cycles (stepped) until the machine is in `state`, at most `timeout_s`. Faulted ends it
  /// too.
  bool waitFor(MachineState state, double timeout_s);

  /// Timing of every activity and component: periods, lateness, execution times as histograms. Any thread, at any time.
  std::vector<rt::ActivityReport> statistics() const { return rt::statisticsOf(deployment()); }
  /// Every property of every component, with unit, range, description, and whether it may change at run time.
  std::vector<rt::PropertyReport> properties() const;
  /// Changes a property that is declared so while the controller runs, e.g. ("Driver1", "proportional_N_per_m",
  /// "50000"): within its range, without a jump of force. The sentence says what was before.
  Answer setProperty(const std::string& component, const std::string& property, const std::string& value);

  /// Where the feedforward's forces come from, for the operator.
  std::string feedforward() const;
  /// Sentences about real-time privileges that were wanted and not obtained; say them loudly.
  std::vector<std::string> warnings() const;
  const rt::Deployment& deployment() const;

  /// Stepped only. `advance` is called before each cycle with the virtual time (ns) up to which the plant has to be
  /// moved on.
  void setPlant(std::function<void(rt::Nanoseconds time)> advance);
  /// Stepped only: executes the next cycle, answers its virtual time.
  rt::Nanoseconds step();
  /// Stepped only: executes all cycles of the next `seconds`.
  void run(double seconds);
  /// Stepped only: the next `seconds` go by without a cycle, as when the machine stands still; the plant goes on.
  void pause(double seconds);

 private:
  Answer moving(RequestKind kind, double timeout_s, std::optional<std::uint64_t> halts);
  Answer end(bool at_any_rate);

  std::unique_ptr<ControllerParts> parts_;
};

}  // namespace knee_robot::control
