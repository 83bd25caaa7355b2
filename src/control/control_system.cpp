#include "knee_robot/control/control_system.h"

#include <algorithm>

#include "controller_parts.h"
#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "operator_sentences.h"

namespace knee_robot::control {
namespace {

constexpr double kQuick_s = 1.0;
constexpr double kEnable_s = 12.0;
const Answer kBeingChanged{false, "the occupancy is being changed; try again"};

}  // namespace

ControlSystem::ControlSystem(const mechanism::Robot& robot, const HardwareFile& hardware,
                             const std::string& deployment_path, hardware::AxisBus& bus, Options options)
    : parts_(std::make_unique<ControllerParts>(robot, hardware, deployment_path, bus, std::move(options))) {}

ControlSystem::~ControlSystem() {
  end(true);
}

Answer ControlSystem::start() {
  if (parts_->started) return {false, "the controller runs already"};
  const hardware::SelfTest test = parts_->bus.selfTest();
  if (!test.passed) {
    return {false, "the hardware's self test failed: " + (test.findings.empty() ? "no finding" : test.findings.back())};
  }
  Monitors& monitors = *parts_->machine.monitors;
  std::string hot;  // why the motors count as hot
  monitors.start_heat(rememberedHeat(parts_->options.heat_file, momentNow(),
                                     std::max<double>(monitors.thermal_time, monitors.thermal_housing), &hot));
  try {
    parts_->deployment->start();
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  // Now that it is known with which privileges the components run.
  parts_->occupancy.recall(parts_->robot, parts_->options.empty || parts_->hardware.bench_without_patient,
                           [this](const PatientLimits& patient) { return parts_->checklist().admit(patient); });
  parts_->started = true;
  const auto settled = [this] {
    const MachineState now = state();
    return snapshot().has_value() && (now == MachineState::Disabled || now == MachineState::Faulted);
  };
  if (!parts_->runner.waitUntil(settled, 1.0)) return {false, "the components started, but nothing is measured"};
  const ControlStatus now = status();
  if (!hot.empty()) hot = "; the motors count as hot: " + hot;
  if (now.state == MachineState::Faulted)
    return {true, "started with a fault, drives off: " + now.fault_sentence + hot};
  const std::string who = parts_->occupancy.whyNobodyMoves();
  return {true, "ready: drives off, holding brakes engaged" + hot +
                    (now.patient.empty() ? "" : "; patient " + now.patient + " is still loaded") +
                    (who.empty() ? "" : "; " + who)};
}

Answer ControlSystem::shutdown() {
  return end(false);
}

Answer ControlSystem::end(bool at_any_rate) {
  if (!parts_->started) return {true, "the controller does not run"};
  const MachineState before = state();
  Answer stopped{true, "drives off, holding brakes engaged"};
  const bool runs = before != MachineState::Disabled && before != MachineState::Faulted;
  if (runs && !parts_->bus.isCarriedByGuardian()) stopped = disable();
  // AxesOutput's own word: a Supervisor that failed says Faulted while the safe stop still runs.
  parts_->runner.waitUntil([this] { return outputsAreOff() || drivesCarry(); }, kSafeStop_s);
  if (drivesCarry() && !at_any_rate) {
    const bool slips = parts_->panel.written()->safe_stop == SafeStopPhase::Carrying;
    const FaultDescription& why = describe(slips ? Fault::HoldDeviceSlips : Fault::OutputLost);
    return {false, std::string("not shut down: ") + why.sentence + "; only the drives carry the platform: support it" +
                       (slips ? "" : ", then press the emergency stop and kill this process")};
  }
  const Answer recorded = stopRecording();
  parts_->deployment->stop();  // whatever still moves: AxesOutput's stopHook
  parts_->started = false;
  if (!stopped.ok) return {false, "shut down, but the safe stop did not answer: " + stopped.sentence};
  if (!recorded.ok) return {false, "shut down, but " + recorded.sentence};
  return {true, "shut down: " + stopped.sentence};
}

bool ControlSystem::outputsAreOff() const {
  const std::optional<AxesWritten> written = parts_->panel.written();
  return !written || written->level == DriveLevel::Off;
}

bool ControlSystem::drivesCarry() const {
  const std::optional<AxesWritten> written = parts_->panel.written();
  if (!parts_->started || !written) return false;
  const bool stranded = written->safe_stop == SafeStopPhase::Engaging && written->level == DriveLevel::Released &&
                        written->status != hardware::IoStatus::Ok && written->status != hardware::IoStatus::FencedOut &&
                        !parts_->bus.stopsByItself();
  return written->safe_stop == SafeStopPhase::Carrying || stranded;
}

/// A request after which the robot may move: who is on it has to be known, and does not change meanwhile. Somebody may
/// stop the robot between the last look and the Supervisor's: then what has begun ends again.
Answer ControlSystem::moving(RequestKind kind, double timeout_s, std::optional<std::uint64_t> halts) {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  if (const std::string why = parts_->occupancy.whyNobodyMoves(); !why.empty()) return {false, why};
  const std::uint64_t expected = halts.value_or(this->halts());
  const auto stopped = [&] { return this->halts() != expected; };
  if (stopped()) return kHalted;
  const Answer answer = parts_->requests.make(kind, timeout_s);
  if (!stopped()) return answer;
  if (const std::optional<RequestKind> end = endOf(kind); end && answer.ok)
    parts_->requests.make(*end, *end == RequestKind::Disable ? kSafeStop_s : kQuick_s);
  return answer.ok ? kHalted : answer;
}

void ControlSystem::refuseToMove() {
  parts_->requests.refuseToMove();
}

Answer ControlSystem::enable(std::optional<std::uint64_t> halts) {
  return moving(RequestKind::Enable, kEnable_s, halts);
}

Answer ControlSystem::disable() {
  parts_->player.halt();
  return parts_->requests.make(RequestKind::Disable, kSafeStop_s);
}

Answer ControlSystem::stop() {
  parts_->player.halt();
  return stopPath();
}

Answer ControlSystem::stopPath() {
  return parts_->requests.make(RequestKind::Stop, kQuick_s);
}

std::uint64_t ControlSystem::halts() const {
  return parts_->player.halts();
}

Answer ControlSystem::emergencyStop() {
  parts_->player.halt();
  return parts_->requests.make(RequestKind::EmergencyStop, kQuick_s);
}

Answer ControlSystem::resetFaults() {
  if (!parts_->started) return {false, "the controller does not run"};
  return parts_->recovery.reset();
}

WishesSoFar ControlSystem::wishesSoFar() const {
  return {parts_->player.halts(), parts_->player.pauses(), parts_->player.speeds(), parts_->player.lastWish(),
          parts_->player.loaded()};
}

Answer ControlSystem::pause() {
  parts_->player.pause();
  const Answer answer = parts_->requests.make(RequestKind::Pause, kQuick_s);
  return answer.ok ? Answer{true, "pausing: the robot comes to rest on its path; resume goes on from there"} : answer;
}

Answer ControlSystem::resume(std::optional<WishesSoFar> since) {
  const WishesSoFar expected = since.value_or(wishesSoFar());
  const auto paused = [&] { return parts_->player.pauses() != expected.pauses; };
  if (paused()) return kPaused;
  const Answer answer = moving(RequestKind::Resume, kQuick_s, expected.halts);
  if (!answer.ok) return answer;
  if (paused()) {
    parts_->requests.make(RequestKind::Pause, kQuick_s);
    return kPaused;
  }
  const double speed = parts_->panel.supervisor().speed;
  if (speed <= 0.0) return {true, "resumed, but the speed is 0 %: set a speed"};
  return {true, "going on at " + shortNumber(100.0 * speed, 4) + " % of the speed"};
}

Answer ControlSystem::setSpeed(double percent) {
  parts_->player.setSpeed();
  return setPathSpeed(percent);
}

Answer ControlSystem::setPathSpeed(double percent) {
  if (!(percent >= 0.0 && percent <= 100.0)) {
    return {false, "the speed must lie between 0 and 100 %, not " + shortNumber(percent)};
  }
  const Answer answer = parts_->requests.make(RequestKind::SetSpeed, kQuick_s, 0.01 * percent);
  return answer.ok ? Answer{true, "the speed is " + shortNumber(percent, 4) + " %"} : answer;
}

Answer ControlSystem::home(std::optional<std::uint64_t> halts) {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  if (parts_->occupancy.patient())
    return {false,
            "a patient is loaded: the robot is homed with nobody on it; get the patient off, then clear_patient"};
  const Answer answer = moving(RequestKind::Home, kEnable_s, halts);
  if (!answer.ok) return answer;
  if (!parts_->hardware.homing.moves()) return {true, "homed: the robot stands at its home lengths"};
  return {true, "homing has begun: one axis after the other, then the drives are switched off"};
}

Answer ControlSystem::confirmHome() {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  if (parts_->occupancy.patient())
    return {false,
            "a patient is loaded: the robot is homed with nobody on it; get the patient off, then clear_patient"};
  const Answer answer = parts_->requests.make(RequestKind::ConfirmHome, kQuick_s);
  return answer.ok ? Answer{true, "the robot stands at its home lengths"} : answer;
}

Answer ControlSystem::guide(std::optional<std::uint64_t> halts) {
  const Answer answer = moving(RequestKind::Guide, kQuick_s, halts);
  if (!answer.ok) return answer;
  return {true,
          "guiding: the axes tremble for a moment, then the platform follows the hand; letting go of the switch holds"};
}

SavedReference ControlSystem::saveGuided(const std::string& path) {
  if (parts_->machine.guide == nullptr)
    return {{false, "the deployment has no HandGuide; add that component (docs/guiding.md)"}};
  if (state() == MachineState::Guiding) return {{false, "the platform is being guided; let go of the switch first"}};
  try {
    const trajectory::Points guided = parts_->machine.guide->path().points();
    return saveGuidedReference(path, guided, parts_->robot, parts_->occupancy.patient());
  } catch (const InputError& error) {
    return {{false, error.what()}};
  }
}

PlayableReference ControlSystem::check(trajectory::Reference reference) const {
  return parts_->player.check(std::move(reference));
}

Answer ControlSystem::loadReference(const trajectory::Reference& reference) {
  try {
    return loadReference(check(reference));
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

Answer ControlSystem::loadReference(const PlayableReference& playable) {
  if (isOnPath(state())) {
    return {false, "a reference is being played; stop it before another one is loaded"};
  }
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  return parts_->player.load(playable, parts_->occupancy.patient());
}

std::string ControlSystem::whyNotForPatient(const PlayableReference& playable) const {
  try {
    if (const auto patient = parts_->occupancy.patient())
      requireWithinPatient(playable.check(), playable.reference(), *patient);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

Answer ControlSystem::play(const PathExpectation& expected) {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  return parts_->player.play(expected);
}

Answer ControlSystem::approach(double speed_m_per_s, const PathExpectation& expected) {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  return parts_->player.approach(speed_m_per_s, parts_->occupancy.patient(), expected);
}

Answer ControlSystem::loadPatient(const std::string& path) {
  const PatientChecklist list = parts_->checklist();
  if (const std::string why = list.whyNever(); !why.empty()) return {false, why};
  const auto changed = [this] { return parts_->properties.whyNotAsDeployed(); };
  if (const std::string why = changed(); !why.empty()) return {false, why};
  try {
    PatientLimits patient = loadPatientLimits(path, parts_->robot);
    const Answer admitted = list.admit(patient);
    if (!admitted.ok) return admitted;
    const PatientRange range = patient.range;
    const std::string name = patient.name;
    const Answer used = parts_->occupancy.change(Occupancy::Patient, std::move(patient), changed);
    if (!used.ok) return used;
    return {true, "patient " + name + ": at most " + shortNumber(1e3 * range.linear_m_per_s, 4) + " mm/s and " +
                      shortNumber(kDegrees * range.angular_rad_per_s, 4) + " deg/s" +
                      (admitted.sentence.empty() ? "" : "; " + admitted.sentence)};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

Answer ControlSystem::clearPatient() {
  const Occupancy left = parts_->hardware.bench_without_patient ? Occupancy::Empty : Occupancy::Unknown;
  const Answer used = parts_->occupancy.change(left, std::nullopt);
  if (!used.ok) return used;
  return {true,
          "no patient; nothing moves until the next one is loaded or declare_empty says that nobody is on the robot"};
}

Answer ControlSystem::declareEmpty() {
  const Answer used = parts_->occupancy.change(Occupancy::Empty, std::nullopt);
  return used.ok ? Answer{true, "nobody is on the robot: only its own limits hold"} : used;
}

Answer ControlSystem::startRecording(const std::string& path) {
  if (!parts_->started) return {false, "the controller does not run"};
  return parts_->recordings.start(path);
}

Answer ControlSystem::stopRecording(const std::string& only) {
  return parts_->recordings.stop(only);
}

ControlStatus ControlSystem::status() const {
  ControlStatus status;
  parts_->report.fill(status);
  parts_->recordings.fill(status);
  parts_->occupancy.fill(status);
  parts_->player.fill(status);
  status.bench_without_patient = parts_->hardware.bench_without_patient;
  status.black_box = parts_->black_box.newest();
  status.black_box_error = parts_->black_box.error();
  return status;
}

std::optional<TrackingRow> ControlSystem::snapshot() const {
  return parts_->panel.row();
}

std::optional<Disturbance> ControlSystem::disturbance() const {
  return parts_->panel.disturbance();
}

bool ControlSystem::waitFor(MachineState wanted, double timeout_s) {
  MachineState found = state();
  parts_->runner.waitUntil(
      [&] {
        found = state();
        return found == wanted || found == MachineState::Faulted;
      },
      timeout_s);
  return found == wanted;
}

std::vector<rt::PropertyReport> ControlSystem::properties() const {
  return parts_->properties.all();
}

Answer ControlSystem::setProperty(const std::string& component, const std::string& property, const std::string& value) {
  const OccupancyRecord::Hold hold(parts_->occupancy);
  if (!hold) return kBeingChanged;
  return parts_->properties.set(component, property, value);
}

std::string ControlSystem::feedforward() const {
  return parts_->feedforward.source();
}

std::vector<std::string> ControlSystem::warnings() const {
  return parts_->deployment->warnings();
}

const rt::Deployment& ControlSystem::deployment() const {
  return *parts_->deployment;
}

void ControlSystem::setPlant(std::function<void(rt::Nanoseconds time)> advance) {
  parts_->runner.setPlant(std::move(advance));
}

rt::Nanoseconds ControlSystem::step() {
  return parts_->runner.step();
}

void ControlSystem::run(double seconds) {
  parts_->runner.run(seconds);
}

void ControlSystem::pause(double seconds) {
  parts_->runner.pause(seconds);
}

}  // namespace knee_robot::control
