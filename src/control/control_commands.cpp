// The operator's commands.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "control_parts.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

constexpr double kQuick_s = 1.0;
constexpr double kSafeStop_s = 8.0;  // longest deceleration, settling, hold and disable delays together
constexpr double kEnable_s = 12.0;
constexpr double kRecovery_s = 0.05;        // components and drives that are taken out of a fault
constexpr double kSlowestApproach = 0.001;  // m/s

/// Rest to rest on a straight line in actuator space, minimum jerk, no axis faster than `speed` or half of its acceleration limit.
trajectory::Points straightLine(const AxisValues& from, const AxisValues& to, const mechanism::Robot& robot,
                                double speed) {
  double duration = 0.5;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double distance = std::abs(to[i] - from[i]);
    duration = std::max(duration, 1.875 * distance / speed);  // peaks of the minimum-jerk profile: 1.875 and 5.7735
    duration = std::max(duration, std::sqrt(5.7735 * distance / (0.5 * robot.actuators[i].acceleration_max_m_per_s2)));
  }
  const auto intervals = static_cast<Eigen::Index>(std::ceil(duration / trajectory::kStreamPeriod));
  trajectory::Points points(intervals + 1, 4);
  for (Eigen::Index k = 0; k <= intervals; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(intervals);
    const double share = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      points(k, static_cast<Eigen::Index>(i)) = from[i] + share * (to[i] - from[i]);
    }
  }
  return points;
}

}  // namespace

Answer ControlSystem::request(RequestKind kind, double timeout_s, double value) {
  if (!started_) return {false, "the controller does not run"};
  if (parts_->supervisor->state() != rt::TaskState::Running) return {false, status().fault_sentence};
  Request asked;
  asked.kind = kind;
  asked.value = value;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    asked.number = ++parts_->requests;
    if (!parts_->panel.request.write(asked)) return {false, "too many requests at once; try again"};
  }
  RequestAnswer answer;
  const bool answered = waitUntil(
      [&] {
        answer = supervisorStatus().answers[asked.number % SupervisorStatus::kAnswers];
        return answer.number == asked.number || parts_->supervisor->state() != rt::TaskState::Running;
      },
      timeout_s);
  if (!answered || answer.number != asked.number) {
    return {false, "no answer within " + shortNumber(timeout_s) + " s; the robot is " + toString(state())};
  }
  return phrase(answer);
}

/// A request that switches the drives on: who is on the robot has to be known, and does not change meanwhile.
Answer ControlSystem::powered(RequestKind kind) {
  if (const std::string why = whyNobodyMoves(); !why.empty()) return {false, why};
  const auto count = [this](int change) {
    const std::lock_guard<std::mutex> lock(mutex_);
    parts_->powering += change;
    return parts_->occupancy != Occupancy::Unknown && !parts_->changing_occupancy;
  };
  const Answer answer =
      count(1) ? request(kind, kEnable_s) : Answer{false, "who is on the robot was just being changed; try again"};
  count(-1);
  return answer;
}

Answer ControlSystem::enable() {
  return powered(RequestKind::Enable);
}
Answer ControlSystem::disable() {
  return request(RequestKind::Disable, kSafeStop_s);
}
Answer ControlSystem::stop() {
  return request(RequestKind::Stop, kQuick_s);
}
Answer ControlSystem::emergencyStop() {
  return request(RequestKind::EmergencyStop, kQuick_s);
}

Answer ControlSystem::pause() {
  const Answer answer = request(RequestKind::Pause, kQuick_s);
  return answer.ok ? Answer{true, "pausing: the robot comes to rest on its path; resume goes on from there"} : answer;
}

Answer ControlSystem::resume() {
  const Answer answer = request(RequestKind::Resume, kQuick_s);
  if (!answer.ok) return answer;
  const double speed = supervisorStatus().speed;
  if (speed <= 0.0) return {true, "resumed, but the speed is 0 %: set a speed"};
  return {true, "going on at " + shortNumber(100.0 * speed, 4) + " % of the speed"};
}

Answer ControlSystem::setSpeed(double percent) {
  if (!(percent >= 0.0 && percent <= 100.0)) {
    return {false, "the speed must lie between 0 and 100 %, not " + shortNumber(percent)};
  }
  const Answer answer = request(RequestKind::SetSpeed, kQuick_s, 0.01 * percent);
  return answer.ok ? Answer{true, "the speed is " + shortNumber(percent, 4) + " %"} : answer;
}

Answer ControlSystem::home() {
  if (patient()) return {false, "a patient is loaded: home the robot before somebody is on it"};
  const Answer answer = powered(RequestKind::Home);
  if (!answer.ok) return answer;
  if (!hardware_.homing.moves()) return {true, "homed: the robot stands at its home lengths"};
  return {true, "homing has begun: one axis after the other, then the drives are switched off"};
}

Answer ControlSystem::confirmHome() {
  if (patient()) return {false, "a patient is loaded: home the robot before somebody is on it"};
  const Answer answer = request(RequestKind::ConfirmHome, kQuick_s);
  return answer.ok ? Answer{true, "the robot stands at its home lengths"} : answer;
}

Answer ControlSystem::setProperty(const std::string& component, const std::string& property, const std::string& value) {
  rt::TaskContext* found = deployment_->component(component);
  if (found == nullptr) return {false, "there is no component " + component.substr(0, 60)};
  if (const Answer allowed = allowChange(component, property, value); !allowed.ok) return allowed;
  if (const auto* driver = dynamic_cast<const Driver*>(found)) {
    const std::string why = parts_->whyNotPassive(*driver, property, std::strtod(value.c_str(), nullptr));
    if (!why.empty()) return {false, why};
  }
  try {
    const rt::PropertyBase* changed = found->property(property);
    const std::string before = changed == nullptr ? "" : changed->valueText();
    rt::changeProperty(*found, property, value);
    return {true, component + "." + property + " is " + changed->valueText() + " " + changed->unit() + " (was " +
                      before + ")"};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

Answer ControlSystem::loadReference(const trajectory::Reference& reference) {
  const MachineState now = state();
  if (now == MachineState::Playing || now == MachineState::Stopping || now == MachineState::Paused) {
    return {false, "a reference is being played; stop it before another one is loaded"};
  }
  try {
    const trajectory::ReferenceCheck check = trajectory::requirePlayable(reference, robot_);
    if (const auto limits = patient()) requireWithinPatient(check, reference, *limits);
    const std::lock_guard<std::mutex> lock(mutex_);
    parts_->reference = check.lengths;
    parts_->reference_name = reference.name;
    const double duration = trajectory::kStreamPeriod * static_cast<double>(check.lengths.rows() - 1);
    return {true, reference.name + ": " + std::to_string(check.lengths.rows()) + " points, " + shortNumber(duration) +
                      " s, within all limits of the robot"};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

Answer ControlSystem::playPath(const trajectory::Points& lengths, const std::string& what) {
  std::vector<AxisValues> points(static_cast<std::size_t>(lengths.rows()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      points[k][i] = lengths(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
    }
  }
  parts_->sync->store().offer(ReferencePath::of(std::move(points)));
  const Answer answer = request(RequestKind::Play, kQuick_s);
  if (answer.ok) {
    const std::lock_guard<std::mutex> lock(mutex_);
    parts_->playing = what;
  }
  return answer.ok ? Answer{true, "playing " + what} : answer;
}

Answer ControlSystem::play() {
  trajectory::Points lengths;
  std::string name;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    lengths = parts_->reference;
    name = parts_->reference_name;
  }
  if (lengths.rows() == 0) return {false, "no reference is loaded"};
  return playPath(lengths, name);
}

Answer ControlSystem::approach(double speed_m_per_s) {
  if (!(speed_m_per_s >= 0.001 && speed_m_per_s <= 0.05)) {
    return {false, "the approach's speed must lie between 0.001 and 0.05 m/s, not " + shortNumber(speed_m_per_s)};
  }
  const std::optional<TrackingRow> row = snapshot();
  AxisValues to{};
  std::string name;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (parts_->reference.rows() == 0) return {false, "no reference is loaded"};
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      to[i] = parts_->reference(0, static_cast<Eigen::Index>(i));
    name = parts_->reference_name;
  }
  if (!row) return {false, "nothing has been measured yet"};
  trajectory::Reference line;
  line.name = "the approach to " + name;
  const auto limits = patient();
  // Slower until the patient's speeds allow it: what turns the platform how fast depends on the pose.
  for (double speed = speed_m_per_s;; speed *= 0.5) {
    line.points = straightLine(row->position_m, to, robot_, speed);
    try {
      const trajectory::ReferenceCheck check = trajectory::requirePlayable(line, robot_);
      if (limits) requireWithinPatient(check, line, *limits);
      return playPath(check.lengths, line.name);
    } catch (const InputError& error) {
      if (!limits || speed < kSlowestApproach) return {false, error.what()};
    }
  }
}

/// Back to Running by whatever way is left. False for what only a restart mends.
bool ControlSystem::revive(rt::TaskContext& component) {
  if (component.state() == rt::TaskState::Exception || component.state() == rt::TaskState::RunTimeError)
    component.recover();
  if (component.state() == rt::TaskState::PreOperational) component.configure();
  if (component.state() == rt::TaskState::Stopped) component.start();
  return component.state() == rt::TaskState::Running;
}

Answer ControlSystem::resetFaults() {
  if (!started_) return {false, "the controller does not run"};
  const MachineState before = state();
  if (before == MachineState::Disabled) return {true, "there is no fault to reset"};
  if (before != MachineState::Faulted)
    return {false, std::string("not possible while the robot is ") + toString(before)};
  if (bus_.isFencedOut() && bus_.reclaim() != hardware::IoStatus::Ok) {
    return {false, "the guardian does not give the outputs back; look whether it runs, then restart the controller"};
  }
  for (const auto& component : deployment_->components()) {
    if (!revive(*component)) return {false, component->name() + " cannot be recovered: " + component->refusal()};
  }
  bus_.acknowledgeFaults();
  waitUntil([] { return false; },
            kRecovery_s);  // a few cycles, so that what is answered is about the recovered components
  waitFor(MachineState::Disabled, kSafeStop_s);  // a safe stop that still runs; or the latched fault
  if (state() == MachineState::Disabled) return {true, "the components were recovered; the robot is disabled"};
  return request(RequestKind::Reset, kQuick_s);
}

}  // namespace knee_robot::control
