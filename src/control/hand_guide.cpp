#include "hand_guide.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/of_model_file.h"
#include "longest_step.h"

namespace knee_robot::control {
namespace {

constexpr double kBrake_N_s_per_m = 2000.0;
constexpr double kBrakesFrom = 0.8, kTooFast = 1.5, kTooFast_s = 0.1;  // shares of the speed limit
/// No hand gets there against the brake: a drive pushes the wrong way, or gives nothing.
constexpr double kRuns = 3.0, kRuns_s = 0.01;
constexpr double kDeepest = 0.9, kWallDamping = 4.0;
/// Beyond that, where it began near it: the loops, which hold where a wall ended the last one, bring it back there when
/// the axes tremble.
constexpr double kNear = 0.15, kDeeper = 0.03;
constexpr double kAverage_s = 0.1;
constexpr double kLetGo_s = 0.2;
constexpr double kCarried = 0.5;  // of what is unknown
/// Of what was identified. While the axes tremble with 0.7 of it, friction hides 0.3 of what is unknown; less than the
/// rest of friction then holds what is not carried.
constexpr double kSureFriction = 0.65;
constexpr double kLeastUnknown_N = 3.0;  // that a model may be wrong by
constexpr int kSilentOrders = 3;         // cycles

bool isFinite(const AxisValues& values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double one) { return std::isfinite(one); });
}

}  // namespace

HandGuide::HandGuide(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name), robot_(robot), inputs_{&command_1, &command_2, &command_3, &command_4}, walls_(robot) {}

void HandGuide::loadModel() {
  if (!model.value().empty()) knowledge_ = dynamics::ofModelFile<ForceKnowledge>(model.value(), robot_);
}

bool HandGuide::configureHook() {
  if (robot_.axes() != hardware::kAxes) return refuse("hand guiding is for four axes");
  try {
    if (!knowledge_) loadModel();
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  return true;
}

bool HandGuide::startHook() {
  out_ = Guidance{};
  known_ = false;
  pose_.forget();
  standBy();
  return true;
}

void HandGuide::updateHook(const rt::Cycle& cycle) {
  const double dt = std::clamp(rt::toSeconds(cycle.time - last_time_), 0.0, kLongestStep_s);
  last_time_ = cycle.time;
  readPorts(dt);
  if (!order_.guiding || silent_ > kSilentOrders || order_.safe_stop || order_.level != DriveLevel::Released) {
    standBy();
  } else {
    guide(dt);
  }
  ++out_.sequence;
  out_.time = cycle.time;
  guidance.write(out_);
}

void HandGuide::readPorts(double dt) noexcept {
  silent_ = orders.read(order_) == rt::FlowStatus::NewData ? 0 : silent_ + 1;
  offered_.read(patient_);
  disturbance.read(disturbed_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    inputs_[i]->read(commands_[i]);
  const bool fresh = measurement.read(measured_) == rt::FlowStatus::NewData;
  path_.measure(order_.homed, measured_.home_number);
  if (fresh && measured_.status == hardware::IoStatus::Ok) {
    const double share = 1.0 - std::exp(-kTwoPi * kCutoff_hz * dt);
    velocity_ += share * (mechanism::Vector4(measured_.velocity_m_per_s.data()) - velocity_);
    known_ = knowledge_ && order_.level == DriveLevel::Released && findMotion();
    if (!velocity_.allFinite()) velocity_.setZero();  // a low-pass keeps for ever what is no number
  }
}

bool HandGuide::findMotion() noexcept {
  const mechanism::Lengths lengths(measured_.position_m.data());
  push_ = VirtualWalls::Push{};
  if (!lengths.allFinite() || !velocity_.allFinite()) return false;
  if (robot_.mechanism) {
    if (!pose_.step(*robot_.mechanism, lengths)) return false;
    mechanism::Vector4 unused;
    if (!mechanism::poseRates(*robot_.mechanism, pose_.pose(), velocity_, mechanism::Vector4::Zero(), pose_velocity_,
                              unused))
      return false;
  }
  push_ = walls_.at(pose_.pose(), lengths, patient_, wall_force);
  return push_.wrench.allFinite() && push_.force.allFinite();
}

GuideStop HandGuide::whyNot() const noexcept {
  if (!knowledge_) return GuideStop::NoModel;
  if (!known_) return GuideStop::LostPose;
  const bool began_near = guided_s_ > 0.0 && began_ > kDeepest - kNear;
  if (!(push_.depth < (began_near ? kDeepest + kDeeper : kDeepest))) return GuideStop::OutsideRange;
  return GuideStop::None;
}

void HandGuide::standBy() noexcept {
  out_.active = false;
  out_.force_N = AxisValues{};
  out_.stop = whyNot();
  guided_s_ = fast_s_ = runs_s_ = sampled_s_ = 0.0;
  stood_m_ = last_m_ = measured_.position_m;
  others_m_ = unknown_N_ = AxisValues{};
  all_stand_s_ = 0.0;
}

/// Of the largest speed that is allowed.
double HandGuide::speedShare() const noexcept {
  double linear = linear_speed, angular = angular_speed;
  if (patient_.given) {
    linear = std::min(linear, patient_.linear_m_per_s);
    angular = std::min(angular, patient_.angular_rad_per_s);
  }
  if (!robot_.mechanism) return velocity_.cwiseAbs().maxCoeff() / linear;
  return std::max({pose_velocity_.head<2>().norm() / linear, std::abs(pose_velocity_[2]) / angular,
                   std::abs(pose_velocity_[3]) / angular});
}

/// Of what was identified: screws run in, and warm grease is thin.
double HandGuide::frictionLeft(std::size_t axis) const noexcept {
  const double left = 1.0 + disturbed_.friction_least[axis];
  return std::isfinite(left) ? std::clamp(left, 0.0, 1.0) : 1.0;
}

double HandGuide::coulomb(std::size_t axis) const noexcept {
  return frictionLeft(axis) * knowledge_->coulomb_N[static_cast<Eigen::Index>(axis)];
}

/// What is left of friction holds what is carried of the unknown, and what is not.
double HandGuide::frictionShare(std::size_t axis) const noexcept {
  const double coulomb_N = coulomb(axis);
  const double unknown_N = std::abs(unknown_N_[axis]);
  if (!out_.active || unknown_N <= kLeastUnknown_N || !(coulomb_N > 0.0)) return share_friction;
  return std::clamp(kSureFriction - (1.0 - kCarried) * unknown_N / coulomb_N, 0.0, share_friction.value());
}

double HandGuide::largestUnknown(std::size_t axis) const noexcept {
  const double coulomb_N = coulomb(axis);
  const double held_N = kSureFriction / (1.0 - kCarried) * coulomb_N;
  return std::min(unknown_load.value(), std::max(held_N, kLeastUnknown_N));
}

/// What the loops carry, and later their integrals keep, beyond the feedforward, without what this gave (`given`) and
/// test pulses.
void HandGuide::weigh(double dt, const AxisValues& given) noexcept {
  const double share = out_.active ? 1.0 : std::min(1.0, dt / kAverage_s);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const AxisCommand& now = commands_[i];
    const double beyond = now.force_N - now.feedforward_N - now.pulse_N - given[i];
    unknown_N_[i] += share * (beyond - unknown_N_[i]);
    if (guided_s_ > weigh_time - kAverage_s && !(std::abs(unknown_N_[i]) <= largestUnknown(i)))
      out_.stop = GuideStop::UnknownLoad;
  }
}

AxisValues HandGuide::frictionForce() const noexcept {
  const bool forth = std::fmod(guided_s_, kTremble_s) < 0.5 * kTremble_s;
  AxisValues force{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double viscous = robot_.mechanism ? knowledge_->parts.parameters[dynamics::extended::kViscous + k]
                                            : knowledge_->parts.axis_parameters(0, k);
    const double sign = std::tanh(velocity_[k] / kSlow_m_per_s);
    const double trembles = (forth ? 1.0 : -1.0) * (1.0 - std::abs(sign));
    force[i] =
        frictionShare(i) * (frictionLeft(i) * std::max(0.0, viscous) * velocity_[k] + coulomb(i) * (sign + trembles));
  }
  return force;
}

void HandGuide::guide(double dt) noexcept {
  const GuideStop why = whyNot();
  if (why != GuideStop::None) {
    const bool began = guided_s_ > 0.0 && why == GuideStop::OutsideRange;
    standBy();
    out_.stop = began ? GuideStop::Wall : why;
    return;
  }
  if (guided_s_ == 0.0) began_ = push_.depth;
  guided_s_ += dt;
  const AxisValues given = out_.force_N;
  weigh(dt, given);
  out_.active = guided_s_ >= weigh_time;
  AxisValues force = frictionForce();
  if (!out_.active) return give(force);
  const double let_go = (1.0 - kCarried) * std::min(1.0, (guided_s_ - weigh_time) / kLetGo_s);
  const double fast = speedShare();
  fast_s_ = fast > kTooFast ? fast_s_ + dt : 0.0;
  runs_s_ = fast > kRuns ? runs_s_ + dt : 0.0;
  if (fast_s_ > kTooFast_s || runs_s_ > kRuns_s) out_.stop = GuideStop::TooFast;
  const double brake = damping * (1.0 + kWallDamping * std::min(1.0, push_.depth)) +
                       kBrake_N_s_per_m * std::clamp((fast - kBrakesFrom) / (1.0 - kBrakesFrom), 0.0, 1.0);
  mechanism::Vector4 wall = push_.force;
  if (robot_.mechanism) {
    // J^T force = wrench.
    const mechanism::Matrix4 jacobian = mechanism::lengthJacobian(*robot_.mechanism, pose_.pose());
    wall += jacobian.transpose().partialPivLu().solve(push_.wrench);
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    force[i] += wall[k] - brake * velocity_[k] - let_go * unknown_N_[i];
  }
  give(force);
  if (!out_.active) return;
  doubt(dt);
  remember(dt);
}

/// What is no number never gets to the Drivers, which would have the brakes engaged in motion: the loops hold instead.
void HandGuide::give(const AxisValues& force_N) noexcept {
  if (isFinite(force_N)) {
    out_.force_N = force_N;
    return;
  }
  standBy();
  out_.stop = GuideStop::LostPose;
}

/// An axis that stands while another one has moved on; where all stand one of them.
void HandGuide::doubt(double dt) noexcept {
  double way = 0.0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    way = std::max(way, std::abs(measured_.position_m[i] - last_m_[i]));
  bool asks = false;
  all_stand_s_ += dt;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double moved = std::abs(measured_.position_m[i] - stood_m_[i]);
    others_m_[i] += way;
    out_.doubted[i] = false;
    if (moved > 3.0 * robot_.actuators[i].metresPerCount()) {
      stood_m_[i] = measured_.position_m[i];
      others_m_[i] = all_stand_s_ = 0.0;
    } else if (others_m_[i] > kMoves_m) {
      others_m_[i] = 0.0;
      out_.doubted[i] = asks = true;
    }
  }
  last_m_ = measured_.position_m;
  if (all_stand_s_ > kAllStand_s) {
    all_stand_s_ = 0.0;
    asked_ = (asked_ + 1) % hardware::kAxes;
    out_.doubted[asked_] = asks = true;
  }
  if (asks) ++out_.suspicion;
}

void HandGuide::remember(double dt) noexcept {
  if (sampled_s_ == 0.0) path_.begin();
  const auto before = static_cast<long>(sampled_s_ / trajectory::kStreamPeriod);
  sampled_s_ += std::max(dt, 1e-9);
  const bool due = path_.size() == 0 || static_cast<long>(sampled_s_ / trajectory::kStreamPeriod) != before;
  if (due && !path_.add(measured_.position_m)) out_.stop = GuideStop::PathFull;
}

}  // namespace knee_robot::control
