#include "knee_robot/control/model_feedforward.h"

#include <algorithm>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/of_model_file.h"
#include "knee_robot/mechanism/kinematics.h"
#include "longest_step.h"

namespace knee_robot::control {
namespace {

/// Between two evaluations of the model.
constexpr double kShortestPeriod_s = 1e-6, kLongestPeriod_s = 0.1;

double approached(double from, double to, double step) noexcept {
  return from + std::clamp(to - from, -step, step);
}

/// The share of a ramp of `duration` seconds that passes in dt.
double rampStep(double dt, double duration) noexcept {
  return duration > 0.0 ? std::min(1.0, dt / duration) : 1.0;
}

}  // namespace

ModelFeedforward::ModelFeedforward(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name), robot_(robot), inputs_{&command_1, &command_2, &command_3, &command_4} {}

void ModelFeedforward::readLaw() {
  const std::optional<Law> wanted = lawNamed(law.value());
  if (!wanted)
    throw InputError(name() + ".law: there is no law " + law.value() +
                     "; feedforward, computed_torque and passivity_based are known");
  if (*wanted != Law::Feedforward && model.value().empty())
    throw InputError(name() + ".law: " + law.value() +
                     " needs an identified model; give one (model:=/path/model.yaml) or set law: feedforward");
  law_.choose(*wanted);
}

void ModelFeedforward::loadModel() {
  readLaw();
  if (!model.value().empty()) {
    model_ = dynamics::ofModelFile<dynamics::PartedModel>(model.value(), robot_);
    source_ = "the model " + model.value();
    for (const dynamics::LeftOutEffect& e : model_->identified->effects.left_out)
      source_ += "; without " + e.name + " of " + e.where + " (" + e.reason + ")";
    return;
  }
  std::optional<dynamics::RobotInertia> inertia;
  if (robot_.mechanism && !robot_.urdf.empty()) inertia = dynamics::loadRobotInertia(robot_);
  model_ = std::make_unique<dynamics::PartedModel>(robot_, inertia);
  source_ = inertia ? "the weights of " + robot_.urdf : "nothing but a payload: the robot file names no URDF";
}

bool ModelFeedforward::configureHook() {
  if (robot_.axes() != hardware::kAxes) return refuse("the feedforward is for four axes");
  try {
    if (!model_) loadModel();
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    largest_N_[i] = largest_share * robot_.actuators[i].forceLimit();
  return true;
}

bool ModelFeedforward::startHook() {
  const std::uint64_t sequence = out_.sequence;
  out_ = FeedforwardForce{};
  out_.sequence = sequence;
  on_ = parts_known_ = false;
  pose_.forget();
  return true;
}

void ModelFeedforward::updateHook(const rt::Cycle& cycle) {
  readPorts();
  const double dt = std::clamp(rt::toSeconds(cycle.time - last_time_), 0.0, kLongestStep_s);
  last_time_ = cycle.time;
  if (order_.drivers_active) {
    carry(dt);
  } else {
    letGo(dt);
  }
  ++out_.sequence;
  out_.time = cycle.time;
  out_.payload_kg = payload;
  feedforward.write(out_);
}

void ModelFeedforward::readPorts() noexcept {
  orders.read(order_);
  new_reading_ = measurement.read(measured_) == rt::FlowStatus::NewData && measured_.status == hardware::IoStatus::Ok;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    followReference(i);
}

void ModelFeedforward::followReference(std::size_t i) noexcept {
  AxisCommand now;
  if (inputs_[i]->read(now) != rt::FlowStatus::NewData) return;
  const auto k = static_cast<Eigen::Index>(i);
  const double dt = rt::toSeconds(now.time - commands_[i].time);
  const double limit = robot_.actuators[i].acceleration_max_m_per_s2;
  const bool follows = now.active && commands_[i].active && dt > 0.0;
  velocity_[k] = now.active ? now.reference_velocity : 0.0;
  acceleration_[k] =
      follows ? std::clamp((now.reference_velocity - commands_[i].reference_velocity) / dt, -limit, limit) : 0.0;
  commands_[i] = now;
}

void ModelFeedforward::letGo(double dt) noexcept {
  dynamics::restParts(*model_, dt, data_);
  on_ = parts_known_ = false;
  pose_.forget();
  openLoop();
  forgetWeight();
  out_.force_N = out_.moving_N = AxisValues{};
  out_.complete = false;
}

void ModelFeedforward::openLoop() noexcept {
  law_.reset(mechanism::Vector4(measured_.position_m.data()));
  since_law_s_ = 0.0;
  out_.loop_N = AxisValues{};
  out_.closes_loop = false;
}

/// The Drivers' references are of the last cycle: they go on for dt. An axis whose Driver is not active has no error.
void ModelFeedforward::closeLoop(double dt) noexcept {
  if (order_.guiding) return openLoop();  // the reference is where the hand is
  since_law_s_ += dt;
  if (law_.law() == Law::Feedforward || !new_reading_) return;
  ControlLaw::Instant at;
  at.pose = pose_.pose();
  at.position = mechanism::Vector4(measured_.position_m.data());
  at.velocity = velocity_;
  at.acceleration = acceleration_;
  at.dt = since_law_s_;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    at.reference[k] = commands_[i].active ? commands_[i].reference_m + dt * velocity_[k] : at.position[k];
  }
  since_law_s_ = 0.0;
  mechanism::Vector4 force;
  const bool known = law_.force(*model_, {stiffness, damping, lambda, velocity_cutoff}, at, force) && force.allFinite();
  if (!known) return openLoop();
  force += model_->identified->effects.gain.cwiseProduct(force);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    out_.loop_N[i] = force[static_cast<Eigen::Index>(i)];
  out_.closes_loop = law_.closesLoop();
}

/// Nothing is known: 0 N, and what was there counts as switched off.
void ModelFeedforward::drop() noexcept {
  openLoop();
  forgetWeight();
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    out_.switched_N[i] -= out_.force_N[i];
  out_.force_N = out_.moving_N = AxisValues{};
  level_ = 0.0;
  taking_over_ = false;
  out_.complete = true;
}

void ModelFeedforward::forgetWeight() noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    out_.declared_N[i] -= out_.weight_N[i];
  out_.weight_N = out_.per_kg_N = AxisValues{};
  weighs_ = false;
}

/// With the payload that is declared now, where `before_kg` was.
void ModelFeedforward::weigh(double before_kg) noexcept {
  const AxisValues before = weighs_ ? total({1.0, 0.0, 0.0, before_kg}, 1.0) : AxisValues{};
  out_.weight_N = total({1.0, 0.0, 0.0, weights_.payload_kg}, 1.0);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    out_.declared_N[i] += out_.weight_N[i] - before[i];
    out_.per_kg_N[i] = parts_.payload_gravity[static_cast<Eigen::Index>(i)];
  }
  weighs_ = true;
}

void ModelFeedforward::carry(double dt) noexcept {
  if (!on_) {
    on_ = taking_over_ = true;
    homing_ = false;
    level_ = 0.0;
    weights_ = asked();
  }
  homing_ = homing_ || order_.homing != 0 || !order_.homed;
  if (homing_ || !findParts()) return drop();
  closeLoop(dt);
  const double kept_level = taking_over_ ? 1.0 : level_;
  const AxisValues kept = total(weights_, kept_level);
  const double kept_kg = weights_.payload_kg;
  const double step = rampStep(dt, switch_time);
  const Weights wanted = asked();
  weights_.gravity = approached(weights_.gravity, wanted.gravity, step);
  weights_.inertia = approached(weights_.inertia, wanted.inertia, step);
  weights_.friction = approached(weights_.friction, wanted.friction, step);
  weights_.payload_kg = approached(weights_.payload_kg, wanted.payload_kg, step * kLargestPayload_kg);
  level_ = std::min(1.0, level_ + (taking_over_ ? rampStep(dt, take_over_time) : step));
  out_.force_N = total(weights_, level_);
  const AxisValues still = total(atRest(weights_), level_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    out_.moving_N[i] = out_.force_N[i] - still[i];
  // While the holding brakes carry, the integrals are empty and nothing has to be made up for.
  for (std::size_t i = 0; i < hardware::kAxes && !taking_over_; ++i)
    out_.switched_N[i] += out_.force_N[i] - kept[i];
  weigh(kept_kg);
  if (level_ >= 1.0) taking_over_ = false;
  out_.complete = !taking_over_;
}

ModelFeedforward::Weights ModelFeedforward::asked() const noexcept {
  return {share_gravity, share_inertia, share_friction, payload};
}

bool ModelFeedforward::findParts() noexcept {
  if (!new_reading_ && parts_known_) return true;
  parts_known_ = false;
  const mechanism::Lengths lengths(measured_.position_m.data());
  if (robot_.mechanism && !pose_.step(*robot_.mechanism, lengths)) return false;
  if (!velocity_.allFinite() || !acceleration_.allFinite()) return false;
  dynamics::WantedInstant at;
  at.period_s = std::clamp(rt::toSeconds(last_time_ - parts_time_), kShortestPeriod_s, kLongestPeriod_s);
  parts_time_ = last_time_;
  at.position_m = mechanism::Vector4(measured_.position_m.data());
  at.velocity_m_per_s = velocity_;
  at.acceleration_m_per_s2 = acceleration_;
  at.coulomb_m_per_s = coulomb_speed;
  at.rest_s = rest_time;
  parts_known_ = dynamics::forceParts(*model_, pose_.pose(), at, data_, parts_) && parts_.allFinite();
  if (!parts_known_) data_.memory = dynamics::MotionMemory{};
  return parts_known_;
}

AxisValues ModelFeedforward::total(const Weights& w, double level) const noexcept {
  const mechanism::Vector4 sum = w.gravity * (parts_.gravity + w.payload_kg * parts_.payload_gravity) +
                                 w.inertia * (parts_.inertia + w.payload_kg * parts_.payload_inertia) +
                                 w.friction * parts_.friction;
  AxisValues forces{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    forces[i] = std::clamp(level * sum[static_cast<Eigen::Index>(i)], -largest_N_[i], largest_N_[i]);
  return forces;
}

}  // namespace knee_robot::control
