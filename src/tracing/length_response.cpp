#include "length_response.h"

#include <Eigen/LU>
#include <algorithm>

#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/mechanism/leg_motion.h"
#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {
namespace {

using mechanism::Matrix4;
using mechanism::Vector4;

constexpr double kStep_m = 1e-4;        // rounding and curvature are both far below the force of such a step
constexpr double kMost_N = 1e5;         // by which a leg's load can change
constexpr double kKnotsEvery_s = 0.04;  // until then the response changes nearly in proportion to time

/// The model's load at one sample, and beside it.
class LoadBeside {
 public:
  LoadBeside(const dynamics::RigidModel& model, const mechanism::Motion& motion)
      : model_(model), mechanism_(model.mechanism), motion_(motion) {
    const Matrix4 jacobian = mechanism::lengthJacobian(mechanism_, motion.pose);
    pose_per_length_ = jacobian.inverse();
    rate_ = jacobian * motion.pose_velocity;
    acceleration_ =
        jacobian * motion.pose_acceleration + mechanism::lengthBias(mechanism_, motion.pose, motion.pose_velocity);
  }
  /// With a leg longer; lengths' rates and accelerations are the same.
  bool longer(int leg, double by_m, Vector4& load) {
    mechanism::Motion moved;
    moved.pose = motion_.pose + pose_per_length_.col(leg) * by_m;
    const Matrix4 inverse = mechanism::lengthJacobian(mechanism_, moved.pose).inverse();
    moved.pose_velocity = inverse * rate_;
    moved.pose_acceleration =
        inverse * (acceleration_ - mechanism::lengthBias(mechanism_, moved.pose, moved.pose_velocity));
    return loadOf(moved, load);
  }
  /// With a leg's length accelerated by 1 m/s^2 more.
  bool faster(int leg, Vector4& load) {
    mechanism::Motion moved = motion_;
    moved.pose_acceleration += pose_per_length_.col(leg);
    return loadOf(moved, load);
  }
  bool here(Vector4& load) { return loadOf(motion_, load); }
  /// With all legs longer, and on their way.
  bool elsewhere(const Vector4& longer, const Vector4& rate, const Vector4& acceleration, Vector4& load) {
    const mechanism::Lengths lengths = mechanism::legLengths(mechanism_, motion_.pose) + longer;
    mechanism::Motion moved;
    return mechanism::motionFromLengths(mechanism_, lengths, rate_ + rate, acceleration_ + acceleration,
                                        motion_.pose + pose_per_length_ * longer,
                                        moved) == mechanism::ForwardStatus::Converged &&
           loadOf(moved, load);
  }

 private:
  bool loadOf(const mechanism::Motion& motion, Vector4& load) const {
    return dynamics::inverseDynamics(model_, motion, load) && load.allFinite();
  }

  const dynamics::RigidModel& model_;
  const mechanism::Mechanism& mechanism_;
  const mechanism::Motion& motion_;
  Matrix4 pose_per_length_;
  Vector4 rate_, acceleration_;
};

/// The model's links, as the fit has them: whether or not a body could be like that.
dynamics::RigidModel linksOf(const EffectInput& in) {
  return {*in.robot->mechanism, in.robot->gravity, dynamics::InertialParameters(in.inertial)};
}

}  // namespace

Eigen::MatrixXd forceOrNone(Eigen::MatrixXd change) {
  const bool is_force = change.allFinite() && change.cwiseAbs().maxCoeff() < kMost_N;
  if (!is_force) change.setZero();
  return change;
}

void LengthResponse::calculate(const EffectInput& in) {
  stride_ = std::max(1, static_cast<int>(kKnotsEvery_s / in.signals().period_s));
  const dynamics::RigidModel links = linksOf(in);
  knots_.resize(static_cast<std::size_t>((in.samples() - 1) / stride_) + 2);
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const std::size_t n = std::min(k * static_cast<std::size_t>(stride_), static_cast<std::size_t>(in.samples()) - 1);
    if (!in.observation->motion.pose_known[n]) continue;
    LoadBeside load(links, in.observation->motion.motion[n]);
    Knot& knot = knots_[k];
    Vector4 here, up, down;
    knot.known = load.here(here);
    for (int j = 0; j < mechanism::kLegs && knot.known; ++j) {
      knot.known = load.longer(j, kStep_m, up) && load.longer(j, -kStep_m, down);
      knot.stiffness.col(j) = (up - down) / (2.0 * kStep_m);
      knot.known = knot.known && load.faster(j, up);
      knot.mass.col(j) = up - here;
    }
  }
}

Eigen::MatrixXd LengthResponse::beyondFirstOrder(const EffectInput& in, const LengthPath& longer) {
  std::call_once(once_, [&] { calculate(in); });
  const auto lastly = static_cast<std::size_t>(in.samples()) - 1;
  const dynamics::RigidModel links = linksOf(in);
  std::vector<Vector4> at_knot(knots_.size(), Vector4::Zero());
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const std::size_t n = std::min(k * static_cast<std::size_t>(stride_), lastly);
    if (!knots_[k].known) continue;
    LoadBeside load(links, in.observation->motion.motion[n]);
    const auto row = static_cast<Eigen::Index>(n);
    const Vector4 length = longer.length_m.row(row), rate = longer.rate.row(row),
                  acceleration = longer.acceleration.row(row);
    Vector4 here, there;
    if (load.here(here) && load.elsewhere(length, rate, acceleration, there))
      at_knot[k] = there - here - knots_[k].stiffness * length - knots_[k].mass * acceleration;
  }
  Eigen::MatrixXd out(in.samples(), mechanism::kLegs);
  for (int n = 0; n < in.samples(); ++n) {
    const auto k = static_cast<std::size_t>(n / stride_);
    const double share = static_cast<double>(n % stride_) / stride_;
    out.row(n) = ((1.0 - share) * at_knot[k] + share * at_knot[k + 1]).transpose();
  }
  return out;
}

LengthResponse::Knot LengthResponse::at(const EffectInput& in, int sample) {
  std::call_once(once_, [&] { calculate(in); });
  const std::size_t k = static_cast<std::size_t>(sample / stride_);
  const Knot &before = knots_[k], &after = knots_[k + 1];
  const double share = static_cast<double>(sample % stride_) / stride_;
  return {before.known && after.known, before.stiffness + share * (after.stiffness - before.stiffness),
          before.mass + share * (after.mass - before.mass)};
}

}  // namespace knee_robot::tracing
