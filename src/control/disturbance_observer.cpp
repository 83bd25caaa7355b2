#include "disturbance_observer.h"

#include <algorithm>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/of_model_file.h"
#include "longest_step.h"

namespace knee_robot::control {
namespace {

void copy(const mechanism::Vector4& from, std::array<double, 4>& to) noexcept {
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = from[static_cast<Eigen::Index>(i)];
}

}  // namespace

DisturbanceObserver::DisturbanceObserver(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name), robot_(robot), inputs_{&command_1, &command_2, &command_3, &command_4} {}

void DisturbanceObserver::loadModel() {
  if (model.value().empty()) {
    std::optional<dynamics::RobotInertia> inertia;
    if (robot_.mechanism && !robot_.urdf.empty()) inertia = dynamics::loadRobotInertia(robot_);
    knowledge_ = std::make_unique<ForceKnowledge>(robot_, inertia);
    return;
  }
  knowledge_ = dynamics::ofModelFile<ForceKnowledge>(model.value(), robot_);
}

bool DisturbanceObserver::configureHook() {
  if (robot_.axes() != hardware::kAxes) return refuse("the observer is for four axes");
  try {
    if (!knowledge_) loadModel();
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    count_m_[i] = robot_.actuators[i].metresPerCount();
    out_.band_N[i] = knowledge_->band_N[static_cast<Eigen::Index>(i)];
  }
  out_.identified = knowledge_->identified;
  return true;
}

bool DisturbanceObserver::startHook() {
  rest_.reset();
  residual_.reset();
  classifier_.reset();
  return true;
}

void DisturbanceObserver::readPorts() noexcept {
  new_reading_ = measurement.read(measured_) == rt::FlowStatus::NewData && measured_.status == hardware::IoStatus::Ok;
  orders.read(order_);
  written.read(written_);
  feedforward.read(model_force_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    inputs_[i]->read(commands_[i]);
}

bool DisturbanceObserver::carries() const noexcept {
  if (!order_.driversCarry() || order_.homing != 0 || !order_.homed) return false;
  return std::all_of(commands_.begin(), commands_.end(), [](const AxisCommand& command) { return command.active; });
}

bool DisturbanceObserver::rests() const noexcept {
  return order_.driversCarry() && (order_.homed || order_.seeks_home) &&
         std::all_of(commands_.begin(), commands_.end(),
                     [](const AxisCommand& command) { return command.active && command.at_rest; });
}

void DisturbanceObserver::updateHook(const rt::Cycle& cycle) {
  readPorts();
  const double dt = std::clamp(rt::toSeconds(cycle.time - last_time_), 0.0, kLongestStep_s);
  last_time_ = cycle.time;
  if (new_reading_) {
    watchRest(dt);
    estimate(dt);
  }
  out_.sequence = measured_.sequence;
  out_.time = cycle.time;
  disturbance.write(out_);
}

void DisturbanceObserver::watchRest(double dt) noexcept {
  RestWatch::Axes error_m{};
  AxisValues pulses_N{};
  bool pulses = false;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    error_m[i] = commands_[i].reference_m - measured_.position_m[i];
    pulses_N[i] = commands_[i].pulse_N;
    pulses = pulses || pulses_N[i] != 0.0;
  }
  if (rest_.step(rests(), pulses, dt, error_m, count_m_)) ++out_.suspicion;
  if (const int asked = turn_.step(rests(), dt, measured_.counts, rest_question); asked >= 0) {
    out_.asked = asked;
    ++out_.questions;
  }
  if (const int asked = homing_turn_.step(order_.homing, dt, measured_.counts); asked >= 0) {
    out_.asked = asked;
    ++out_.questions;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    witness_[i].step(i, dt, pulses_N, error_m);
    out_.felt[i] = pulses_N[i] != 0.0 ? witness_[i].felt(i, count_m_) : out_.felt[i];
  }
}

void DisturbanceObserver::estimate(double dt) noexcept {
  if (carries()) {
    ResidualEstimator::Input input;
    input.position_m = mechanism::Lengths(measured_.position_m.data());
    input.velocity_m_per_s = mechanism::Vector4(measured_.velocity_m_per_s.data());
    input.force_N = mechanism::Vector4(written_.force_N.data());
    input.payload_kg = model_force_.payload_kg;
    input.dt = dt;
    residual_.step(*knowledge_, input);
  } else {
    residual_.reset();
  }
  const ResidualEstimator::Estimate& now = residual_.estimate();
  const DisturbanceClassifier::Verdict& verdict = classifier_.step(*knowledge_, now, dt, order_.guiding);
  copy(now.expected_N, out_.expected_N);
  copy(now.residual_N, out_.residual_N);
  copy(now.certain_N, out_.certain_N);
  copy(now.rms_N, out_.rms_N);
  copy(now.wrench, out_.wrench);
  copy(now.wrench_band, out_.wrench_band);
  copy(now.pose, out_.pose);
  copy(verdict.push, out_.push);
  copy(verdict.friction_growth, out_.friction_growth);
  copy(verdict.friction_least, out_.friction_least);
  out_.known = now.known;
  out_.pushed = verdict.pushed;
  out_.carries = verdict.carries;
  out_.load_kg = verdict.load_kg;
  out_.load_m = verdict.load_m;
  out_.friction_changed = verdict.friction_changed;
  out_.model_holds = verdict.holds;
}

}  // namespace knee_robot::control
