#include "knee_robot/control/control_law.h"

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {

std::optional<Law> lawNamed(const std::string& name) {
  if (name == "feedforward") return Law::Feedforward;
  if (name == "computed_torque") return Law::ComputedTorque;
  if (name == "passivity_based") return Law::PassivityBased;
  return std::nullopt;
}

void ControlLaw::reset(const mechanism::Vector4& position) noexcept {
  velocity_.setZero();
  last_position_ = position;
}

bool ControlLaw::force(const dynamics::PartedModel& model, const Gains& gains, const Instant& at,
                       mechanism::Vector4& force) noexcept {
  force.setZero();
  if (law_ == Law::Feedforward) return true;
  if (at.dt > 0.0) {
    const double tau = 1.0 / (kTwoPi * gains.cutoff_hz);
    velocity_ += ((at.position - last_position_) / at.dt - velocity_) * at.dt / (tau + at.dt);
    last_position_ = at.position;
  }
  const mechanism::Vector4 error = at.reference - at.position, speed_error = at.velocity - velocity_;
  dynamics::AuxiliaryMotion wanted, measured;
  measured.velocity = measured.reference = at.velocity;
  measured.acceleration = at.acceleration;
  wanted.velocity = velocity_;
  if (law_ == Law::ComputedTorque) {
    wanted.reference = velocity_;
    wanted.acceleration = at.acceleration + gains.damping_per_s * speed_error + gains.stiffness_per_s2 * error;
  } else {
    wanted.reference = at.velocity + gains.lambda_per_s * error;
    wanted.acceleration = at.acceleration + gains.lambda_per_s * speed_error;
  }
  mechanism::Vector4 with = mechanism::Vector4::Zero(), without = mechanism::Vector4::Zero();
  if (!dynamics::auxiliaryForces(model, at.pose, wanted, data_, with) ||
      !dynamics::auxiliaryForces(model, at.pose, measured, data_, without)) {
    return false;
  }
  force = with - without;
  return true;
}

std::string ControlLaw::whyNotPassive(double lambda, double proportional, double integral, double derivative) {
  const double rest = proportional - derivative * lambda;
  if (lambda > 0.0 && derivative > 0.0 && rest > 0.0 && rest * lambda >= integral) return "";
  const double root = proportional * proportional - 4.0 * derivative * integral;
  if (!(derivative > 0.0) || !(root > 0.0))
    return "no lambda_per_s makes its loop passive: it needs P^2 > 4 D I; lower the integral or raise the "
           "proportional gain";
  const double half = std::sqrt(root);
  return "lambda_per_s must lie between " + shortNumber((proportional - half) / (2.0 * derivative)) + " and " +
         shortNumber((proportional + half) / (2.0 * derivative)) + ", not at " + shortNumber(lambda);
}

}  // namespace knee_robot::control
