// What the operator is told: state, faults, answers.
#include <algorithm>
#include <cmath>

#include "control_parts.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

/// Longer without a word from the Supervisor than any pause of a machine that may be let near the robot.
constexpr rt::Nanoseconds kSilence = 200'000'000;

}  // namespace

bool ControlSystem::Parts::standsAtStart() {
  TrackingRow row;
  if (reference.rows() == 0 || panel.row.read(row) == rt::FlowStatus::NoData) return false;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double first = reference(0, static_cast<Eigen::Index>(i));
    if (!(std::abs(row.position_m[i] - first) <= sync->start_tolerance_m)) return false;
  }
  return true;
}

std::vector<rt::PropertyReport> ControlSystem::properties() const {
  std::vector<rt::PropertyReport> all;
  for (const auto& component : deployment_->components()) {
    for (rt::PropertyReport& one : rt::propertiesOf(*component))
      all.push_back(std::move(one));
  }
  return all;
}

ControlStatus ControlSystem::status() const {
  SupervisorStatus supervisor = supervisorStatus();
  overrideWhenSilent(supervisor);
  ControlStatus status;
  status.state = supervisor.state;
  status.path_time_s = supervisor.path_time_s;
  status.path_duration_s = supervisor.path_duration_s;
  status.progress = supervisor.path_duration_s > 0.0 ? supervisor.path_time_s / supervisor.path_duration_s : 0.0;
  status.time_scale = supervisor.time_scale;
  status.speed_percent = 100.0 * supervisor.speed;
  status.axis_homed = supervisor.homed;
  status.homed = std::all_of(supervisor.homed.begin(), supervisor.homed.end(), [](bool homed) { return homed; });
  status.bench_without_patient = hardware_.bench_without_patient;
  status.safe_stops = supervisor.safe_stops;
  status.guiding = sentenceOf(supervisor.guide_stop);
  describeFault(supervisor, status);
  const RecordingResult recording = parts_->drain->progress();
  status.recording = recording.path;
  status.recorded_rows = recording.rows;
  status.dropped_rows = recording.dropped;
  status.skipped_cycles = recording.skipped;
  status.black_box = parts_->black_box_writer->newest();
  status.black_box_error = parts_->black_box_writer->error();
  const std::lock_guard<std::mutex> lock(mutex_);
  MonitorVerdict verdict;
  if (parts_->panel.verdict.read(verdict) != rt::FlowStatus::NoData) status.thermal = verdict.heat;
  status.occupancy = parts_->occupancy;
  if (parts_->patient) status.patient = parts_->patient->name;
  status.reference = parts_->reference_name;
  status.at_start = parts_->standsAtStart();
  const bool on_a_path = status.state == MachineState::Playing || status.state == MachineState::Paused ||
                         status.state == MachineState::Stopping;
  if (on_a_path) status.playing = parts_->playing;
  return status;
}

/// The last word of a Supervisor that failed or hangs is old; AxesOutput makes the safe stop without it.
void ControlSystem::overrideWhenSilent(SupervisorStatus& supervisor) const {
  if (!started_) return;
  const rt::TaskState task = parts_->supervisor->state();
  const bool failed = task != rt::TaskState::Running;
  if (!failed && deployment_->now() - supervisor.time <= kSilence) return;
  supervisor.state = MachineState::Faulted;
  supervisor.fault = Fault::OrdersStale;
  if (failed) supervisor.fault = task == rt::TaskState::FatalError ? Fault::ComponentFatal : Fault::ComponentException;
  supervisor.fault_axis = 0;
  supervisor.fault_component = -1;
}

void ControlSystem::describeFault(const SupervisorStatus& supervisor, ControlStatus& status) const {
  status.fault = supervisor.fault;
  status.fault_axis = supervisor.fault_axis;
  if (supervisor.fault == Fault::None) return;
  const FaultDescription& description = describe(supervisor.fault);
  status.fault_name = description.name;
  std::string place = supervisor.fault_axis > 0 ? "axis " + std::to_string(supervisor.fault_axis) + ": " : "";
  const rt::TaskContext* component = nullptr;
  const auto& watched = parts_->supervisor->watched();
  if (supervisor.fault_component >= 0) component = watched[static_cast<std::size_t>(supervisor.fault_component)];
  if (parts_->supervisor->state() >= rt::TaskState::Exception) component = parts_->supervisor;
  if (component != nullptr) {
    place = component->name() + ": ";
    if (component->state() >= rt::TaskState::Exception) place += std::string(component->refusal()) + ": ";
  }
  status.fault_sentence = place + description.sentence + "; " + description.remedy;
}

/// home() and confirmHome(), each where the hardware file asks for the other.
Answer ControlSystem::noProcedure() const {
  if (hardware_.homing.method == HomingMethod::HandPlaced) {
    return {false, "home is set by hand: place the robot at its home lengths with the drives off, then confirm"};
  }
  return {false, "there is nothing to confirm: the hardware file's homing method is another"};
}

Answer ControlSystem::phrase(const RequestAnswer& answer) const {
  const ControlStatus now = status();
  const std::string state = toString(now.state);
  switch (answer.result) {
    case RequestResult::Done:
      return {true, "the robot is " + state};
    case RequestResult::WrongState:
      return {false, "not possible while the robot is " + state +
                         (now.fault_sentence.empty() ? "" : " (" + now.fault_sentence + ")")};
    case RequestResult::NoReference:
      return {false, "no reference is loaded"};
    case RequestResult::NotAtStart:
      return {false, "axis " + std::to_string(answer.axis) + " stands " + shortNumber(1e3 * answer.distance_m, 4) +
                         " mm from the reference's first point, more than the " +
                         shortNumber(1e3 * parts_->sync->start_tolerance_m) + " mm allowed; approach it first"};
    case RequestResult::NotReady:
      return {false, "the components, the encoders or the outputs are not ready; try again, then look at their states"};
    case RequestResult::CauseRemains:
      return {false, "the cause is still there: " + now.fault_sentence};
    case RequestResult::NeedsRestart:
      return {false, "only a restart of the controller clears this: " + now.fault_sentence};
    case RequestResult::Superseded:
      return {false, "another request came in between; the robot is " + state};
    case RequestResult::NotHomed:
      return {false, "the axes do not know where they are; home the robot first"};
    case RequestResult::NoProcedure:
      return noProcedure();
    case RequestResult::HomeShifted:
      return {false,
              "axis " + std::to_string(answer.axis) + " stands " + shortNumber(1e3 * answer.distance_m, 4) +
                  " mm from its home length by the counters: either they lost counts (restart the controller) or the "
                  "robot was not placed at home"};
    case RequestResult::OutOfRange:
      return {false, "the value is not allowed"};
    case RequestResult::NoEnablingSwitch:
      return {false, "no enabling switch is configured (hardware file: digital_inputs: enabling_switch)"};
    case RequestResult::NoGuide:
      return {false, "the deployment has no HandGuide; add that component"};
    case RequestResult::BrakesUntested:
      return {false,
              "the brakes are not tested at enabling: all axes need hold_device: brake, and Supervisor.brake_test_N "
              "more than 0"};
    case RequestResult::SwitchNotHeld:
      return {false, "the enabling switch is not held: hold it, then ask again"};
    case RequestResult::SwitchNotReleased:
      return {false,
              "the enabling switch was not let go of since the robot was enabled or the platform was guided last"};
    case RequestResult::GuideRefused:
      return {false, now.guiding};
    case RequestResult::Failed:
      return {false, "a fault came in between: " + now.fault_sentence};
  }
  return {false, "?"};
}

}  // namespace knee_robot::control
