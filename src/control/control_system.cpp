#include "knee_robot/control/control_system.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>

#include "control_parts.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/component_types.h"

namespace knee_robot::control {
namespace {

constexpr int kStepsPerDrain = 64;

AxisValues lengthsAtStart(const mechanism::Robot& robot, const ControlSystem::Options& options) {
  if (options.lengths_at_start_m) return *options.lengths_at_start_m;
  AxisValues lengths{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lengths[i] = robot.actuators[i].home_length_m;
  return lengths;
}

/// Drives on a bus are told the period, and the bus' load was computed with it.
void requireBusPeriod(const HardwareFile& hardware, const rt::Deployment& deployment, const std::string& path) {
  if (!hardware.can) return;
  for (const auto& activity : deployment.activities()) {
    const double period = rt::toSeconds(activity->options().period);
    if (std::abs(period - hardware.can->period_s) < 1e-9) continue;
    throw InputError(path + ": activity " + activity->name() + " has period_s " + shortNumber(period) + ", and " +
                     hardware.path + " can.period_s " + shortNumber(hardware.can->period_s) +
                     "; one servo cycle is one SYNC: make them equal");
  }
}

const mechanism::Robot& requireFourAxes(const mechanism::Robot& robot) {
  if (robot.axes() != hardware::kAxes) {
    throw InputError(robot.path + ": actuators: the controller drives four actuators, not " +
                     std::to_string(robot.axes()));
  }
  return robot;
}

}  // namespace

ControlSystem::ControlSystem(const mechanism::Robot& robot, const HardwareFile& hardware,
                             const std::string& deployment_path, hardware::AxisBus& bus, Options options)
    : robot_(requireFourAxes(robot)), hardware_(hardware), options_(options), bus_(bus) {
  const AxisValues lengths = lengthsAtStart(robot, options);
  rt::TypeFactory types = options_.types;  // these win
  types.merge(componentTypes(robot, hardware, bus, lengths));
  deployment_ = std::make_unique<rt::Deployment>(deployment_path, types, options_.execution);
  requireBusPeriod(hardware, *deployment_, deployment_path);
  parts_ = std::make_unique<Parts>(*deployment_);
  parts_->prepareFeedforward(*deployment_, robot, options_);
  parts_->patient_memory = PatientMemory(options_.patient_memory);
  rt::connect(parts_->panel.request, parts_->supervisor->request, rt::ConnPolicy::buffer(16));
  rt::connect(parts_->supervisor->status, parts_->panel.status);
  rt::connect(parts_->monitors->verdict, parts_->panel.verdict);
  rt::connect(parts_->recorder->row, parts_->panel.row);
  if (parts_->observer != nullptr) rt::connect(parts_->observer->disturbance, parts_->panel.disturbance);
  for (const auto& component : deployment_->components()) {
    if (component.get() == parts_->supervisor) continue;
    component.get() == parts_->output ? parts_->supervisor->watchOutput(*component)
                                      : parts_->supervisor->watch(*component);
  }
  for (const auto& activity : deployment_->activities()) {
    activity->setOverrunHandler([supervisor = parts_->supervisor] { supervisor->reportOverrun(); });
  }
  const bool threaded = options.execution == rt::Execution::Threads;
  // Incremental encoders know their place anew at every start. Stepped runs are to be the same whenever they are made.
  parts_->drain = std::make_unique<RecordingDrain>(*parts_->recorder, robot.axes(), threaded,
                                                   threaded ? static_cast<std::int64_t>(std::time(nullptr)) : 0);
  parts_->black_box_writer = std::make_unique<BlackBoxWriter>(*parts_->black_box, options.black_box_folder,
                                                              options.execution == rt::Execution::Threads);
  parts_->heat_memory = std::make_unique<HeatMemory>(options.heat_file, options.execution == rt::Execution::Threads);
  rt::connect(parts_->monitors->verdict, parts_->heat_memory->verdict);
}

ControlSystem::~ControlSystem() {
  end(true);
  parts_->heat_memory.reset();
  parts_->black_box_writer.reset();
  parts_->drain.reset();  // its thread uses the Recorder
}

Answer ControlSystem::start() {
  if (started_) return {false, "the controller runs already"};
  const hardware::SelfTest test = bus_.selfTest();
  if (!test.passed) {
    return {false, "the hardware's self test failed: " + (test.findings.empty() ? "no finding" : test.findings.back())};
  }
  parts_->monitors->start_heat(rememberedHeat(
      options_.heat_file, static_cast<double>(std::time(nullptr)),
      std::max<double>(parts_->monitors->thermal_time, parts_->monitors->thermal_housing), &parts_->heat_refused));
  recallPatient();
  try {
    deployment_->start();
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  started_ = true;
  const auto settled = [this] {
    const MachineState now = state();
    return snapshot().has_value() && (now == MachineState::Disabled || now == MachineState::Faulted);
  };
  if (!waitUntil(settled, 1.0)) return {false, "the components started, but nothing is measured"};
  const ControlStatus now = status();
  const std::string hot = parts_->heat_refused.empty() ? "" : "; the motors count as hot: " + parts_->heat_refused;
  if (now.state == MachineState::Faulted)
    return {true, "started with a fault, drives off: " + now.fault_sentence + hot};
  const std::string who = whyNobodyMoves();
  return {true, "ready: drives off, hold devices engaged" + hot +
                    (now.patient.empty() ? "" : "; patient " + now.patient + " is still loaded") +
                    (who.empty() ? "" : "; " + who)};
}

Answer ControlSystem::shutdown() {
  return end(false);
}

Answer ControlSystem::end(bool at_any_rate) {
  if (!started_) return {true, "the controller does not run"};
  const MachineState before = state();
  Answer stopped{true, "drives off, hold devices engaged"};
  if (before != MachineState::Disabled && before != MachineState::Faulted) stopped = disable();
  const ControlStatus now = status();
  const bool carries = now.state == MachineState::SafeStopping && now.fault == Fault::HoldDeviceSlips;
  if (carries && !at_any_rate) return {false, "not shut down: " + now.fault_sentence};
  const Answer recorded = stopRecording();
  deployment_->stop();  // whatever still moves: AxesOutput's stopHook
  started_ = false;
  if (!stopped.ok) return {false, "shut down, but the safe stop did not answer: " + stopped.sentence};
  if (!recorded.ok) return {false, "shut down, but " + recorded.sentence};
  return {true, "shut down: " + stopped.sentence};
}

bool ControlSystem::waitUntil(const std::function<bool()>& done, double timeout_s) {
  if (options_.execution == rt::Execution::Stepped) {
    const rt::Nanoseconds end = deployment_->nextRelease() + rt::fromSeconds(timeout_s);
    while (!done()) {
      if (deployment_->nextRelease() >= end) return false;
      step();
    }
    return true;
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (!done()) {
    if (std::chrono::steady_clock::now() >= end) return done();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

rt::Nanoseconds ControlSystem::step() {
  if (advance_plant_) advance_plant_(deployment_->nextRelease());
  const rt::Nanoseconds time = deployment_->step();
  if (++parts_->steps % kStepsPerDrain == 0) {
    parts_->drain->drain();
    parts_->black_box_writer->write();
  }
  return time;
}

void ControlSystem::run(double seconds) {
  const rt::Nanoseconds end = deployment_->nextRelease() + rt::fromSeconds(seconds);
  while (deployment_->nextRelease() < end)
    step();
}

bool ControlSystem::waitFor(MachineState wanted, double timeout_s) {
  MachineState found = state();
  waitUntil(
      [&] {
        found = state();
        return found == wanted || found == MachineState::Faulted;
      },
      timeout_s);
  return found == wanted;
}

std::vector<std::string> ControlSystem::warnings() const {
  return deployment_->warnings();
}

std::string ControlSystem::feedforward() const {
  if (parts_->feedforward == nullptr) return "none: the deployment has no ModelFeedforward";
  const double payload = parts_->feedforward->payload;
  const std::string source = parts_->feedforward->source();
  return payload > 0.0 ? source + ", and a payload of " + shortNumber(payload) + " kg" : source;
}

Answer ControlSystem::startRecording(const std::string& path) {
  if (!started_) return {false, "the controller does not run"};
  try {
    parts_->drain->start(path);
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  chooseTestPulses();
  return {true, "recording to " + path};
}

/// Test pulses are forces that no model explains, and rows with them are left out of a fit: while a robot that is declared empty is
/// recorded there are none without a suspicion. With a patient they stay.
void ControlSystem::chooseTestPulses() {
  const bool allowed = !parts_->drain->isRecording() || parts_->occupancy != Occupancy::Empty;
  for (const auto& component : deployment().components()) {
    if (auto* driver = dynamic_cast<Driver*>(component.get())) driver->allowTestPulses(allowed);
  }
}

Answer ControlSystem::stopRecording() {
  const RecordingResult result = parts_->drain->stop();
  chooseTestPulses();
  if (result.path.empty()) return {true, "nothing was being recorded"};
  std::string sentence = result.path + " has " + std::to_string(result.rows) + " rows";
  if (result.skipped > 0) {
    sentence += "; the machine skipped " + std::to_string(result.skipped) + " cycles, seen as gaps of time_s";
  }
  if (!result.error.empty()) return {false, "the recording is incomplete: " + result.error + "; " + sentence};
  if (result.dropped == 0) return {true, sentence};
  return {false, "the recording is incomplete: " + std::to_string(result.dropped) + " rows were dropped; " + sentence};
}

std::optional<TrackingRow> ControlSystem::snapshot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  TrackingRow row;
  if (parts_->panel.row.read(row) == rt::FlowStatus::NoData) return std::nullopt;
  return row;
}

std::optional<Disturbance> ControlSystem::disturbance() const {
  if (parts_->observer == nullptr) return std::nullopt;
  const std::lock_guard<std::mutex> lock(mutex_);
  Disturbance found;
  if (parts_->panel.disturbance.read(found) == rt::FlowStatus::NoData) return std::nullopt;
  return found;
}

SupervisorStatus ControlSystem::supervisorStatus() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  SupervisorStatus status;
  parts_->panel.status.read(status);
  return status;
}

}  // namespace knee_robot::control
