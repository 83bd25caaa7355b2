#include "machine_report.h"

#include <algorithm>
#include <cstdio>

#include "knee_robot/hardware/can/canopen.h"
#include "operator_sentences.h"

namespace knee_robot::control {
namespace {

/// Longer without a word from the Supervisor than any pause of a machine that may be let near the robot.
constexpr rt::Nanoseconds kSilence = 200'000'000;

/// What the drive itself said, to be looked up in its manual.
std::string codeOf(const SupervisorStatus& said) {
  if (said.fault_code == 0) return "";
  char text[80];
  std::snprintf(text, sizeof text, " (code 0x%04X, %s)", static_cast<unsigned>(said.fault_code),
                hardware::can::emergencyText(said.fault_code));
  return text;
}

/// After a pause of the controller nearly everything looks wrong; who reads of an obstacle must know of it.
std::string pauseOf(const SupervisorStatus& said) {
  if (said.fault_paused_s <= 0.0) return "";
  char text[120];
  std::snprintf(
      text, sizeof text,
      " (the controller had stood still for %.0f ms shortly before, which may be why: look for what held it up)",
      1e3 * said.fault_paused_s);
  return text;
}

}  // namespace

void MachineReport::fill(ControlStatus& status) const {
  const SupervisorStatus said = supervisor();
  status.state = said.state;
  status.fault = said.fault;
  status.fault_axis = said.fault_axis;
  if (said.fault != Fault::None) status.fault_name = describe(said.fault).name;
  status.fault_sentence = sentenceOfFault(said);
  status.path_time_s = said.path_time_s;
  status.path_duration_s = said.path_duration_s;
  status.progress = said.path_duration_s > 0.0 ? said.path_time_s / said.path_duration_s : 0.0;
  status.time_scale = said.time_scale;
  status.speed_percent = 100.0 * said.speed;
  status.pause_asked = said.pause_path;
  status.axis_homed = said.homed;
  status.homed = std::all_of(said.homed.begin(), said.homed.end(), [](bool homed) { return homed; });
  status.safe_stops = said.safe_stops;
  status.guiding = sentenceOf(said.guide_stop);
  if (const std::optional<MonitorVerdict> verdict = panel_.verdict()) status.thermal = verdict->heat;
}

/// The Supervisor knows of the controller's own drives only: what the guardian lets carry is no robot that is off.
SupervisorStatus MachineReport::supervisor() const {
  SupervisorStatus said = ownWord();
  const bool off = said.state == MachineState::Faulted || said.state == MachineState::Disabled;
  if (off && bus_.isCarriedByGuardian()) said.state = MachineState::SafeStopping;
  return said;
}

/// The last word of a Supervisor that failed or hangs is old; AxesOutput makes the safe stop without it.
SupervisorStatus MachineReport::ownWord() const {
  SupervisorStatus said = panel_.supervisor();
  if (!started_) return said;
  const rt::TaskState task = machine_.supervisor->state();
  const bool failed = task != rt::TaskState::Running;
  if (!failed && deployment_.now() - said.time <= kSilence) return said;
  said.state = MachineState::Faulted;
  said.fault = Fault::OrdersStale;
  if (failed) said.fault = task == rt::TaskState::FatalError ? Fault::ComponentFatal : Fault::ComponentException;
  said.fault_axis = 0;
  said.fault_component = -1;
  said.fault_code = 0;
  said.fault_paused_s = 0.0;
  return said;
}

std::string MachineReport::sentenceOfFault(const SupervisorStatus& said) const {
  if (said.fault == Fault::None) return "";
  std::string location = said.fault_axis > 0 ? "axis " + std::to_string(said.fault_axis) + ": " : "";
  const rt::TaskContext* component = nullptr;
  const auto& watched = machine_.supervisor->watched();
  if (said.fault_component >= 0) component = watched[static_cast<std::size_t>(said.fault_component)];
  if (machine_.supervisor->state() >= rt::TaskState::Exception) component = machine_.supervisor;
  if (component != nullptr) {
    location = component->name() + ": ";
    if (component->state() >= rt::TaskState::Exception) location += std::string(component->refusal()) + ": ";
  }
  const FaultDescription& description = describe(said.fault);
  const std::string carries =
      bus_.isCarriedByGuardian()
          ? "; KEEP AWAY: the guardian still lets the drives carry the platform, until the brakes hold"
          : "";
  return location + description.sentence + codeOf(said) + pauseOf(said) + carries + "; " + description.remedy;
}

}  // namespace knee_robot::control
