#include "residual_estimator.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::control {
namespace {

mechanism::Vector4 forceLimits(const mechanism::Robot& robot) {
  mechanism::Vector4 limits = mechanism::Vector4::Zero();
  for (int i = 0; i < robot.axes() && i < mechanism::kLegs; ++i)
    limits[i] = robot.actuators[static_cast<std::size_t>(i)].forceLimit();
  return limits;
}

double beyond(double value, double dead_band) noexcept {
  return std::abs(value) <= dead_band ? 0.0 : value - std::copysign(dead_band, value);
}

}  // namespace

ForceKnowledge::ForceKnowledge(const mechanism::Robot& robot, const std::optional<dynamics::RobotInertia>& inertia)
    : parts(robot, inertia),
      coulomb_N(kUnknownFriction * forceLimits(robot)),
      band_N(kUnknownBand * forceLimits(robot)) {}

ForceKnowledge::ForceKnowledge(const dynamics::Model& model, const mechanism::Robot& robot)
    : parts(model, robot),
      identified(true),
      traced(!dynamics::effectsOfController(model).empty()),
      band_N(kUnknownBand * forceLimits(robot)) {
  coulomb_N = parts.mechanism
                  ? mechanism::Vector4(parts.parameters.segment<mechanism::kLegs>(dynamics::extended::kCoulomb))
                  : mechanism::Vector4(parts.axis_parameters.row(1).transpose());
  coulomb_N = coulomb_N.cwiseAbs();
  for (std::size_t i = 0; i < model.residual_rms_N.size() && i < static_cast<std::size_t>(mechanism::kLegs); ++i) {
    const double rms = model.residual_rms_N[i];
    if (std::isfinite(rms) && rms > 0.0) band_N[static_cast<Eigen::Index>(i)] = kBand * rms;
  }
}

mechanism::Vector4 ResidualEstimator::certain(const mechanism::Vector4& residual,
                                              const mechanism::Vector4& hidden) noexcept {
  mechanism::Vector4 all;
  for (int i = 0; i < mechanism::kLegs; ++i)
    all[i] = beyond(residual[i], hidden[i]);
  return all;
}

void ResidualEstimator::reset() noexcept {
  settled_s_ = 0.0;
  pose_.forget();
  const mechanism::Vector4 rms = out_.rms_N;
  out_ = Estimate{};
  out_.rms_N = rms;
}

bool ResidualEstimator::findPose(const ForceKnowledge& knowledge, const mechanism::Lengths& lengths) noexcept {
  if (!knowledge.parts.mechanism) return true;
  if (!pose_.step(*knowledge.parts.mechanism, lengths)) return false;
  out_.pose = pose_.pose();
  return true;
}

/// Effects that trace found remember. At rest friction is let go of: what is left of it there nobody knows.
bool ResidualEstimator::expect(const ForceKnowledge& knowledge, const Input& in,
                               const mechanism::Vector4& acceleration) noexcept {
  constexpr double kLetsGo_s = 0.05;
  if (!knowledge.traced)
    return dynamics::forceParts(knowledge.parts, out_.pose, velocity_.twice, acceleration, kSlow_m_per_s, data_,
                                parts_);
  dynamics::WantedInstant at;
  at.period_s = std::max(1e-6, in.dt);
  at.position_m = in.position_m;
  at.velocity_m_per_s = velocity_.twice;
  at.acceleration_m_per_s2 = acceleration;
  at.coulomb_m_per_s = kSlow_m_per_s;
  at.rest_s = kLetsGo_s;
  return dynamics::forceParts(knowledge.parts, out_.pose, at, data_, parts_);
}

const ResidualEstimator::Estimate& ResidualEstimator::step(const ForceKnowledge& knowledge, const Input& in) noexcept {
  if (settled_s_ <= 0.0) {
    force_.once = force_.twice = in.force_N;
    velocity_.once = velocity_.twice = mechanism::Vector4::Zero();
  }
  const double rate = kTwoPi * kCutoff_hz;
  const double share = 1.0 - std::exp(-rate * in.dt);
  force_.step(in.force_N, share);
  velocity_.step(in.velocity_m_per_s, share);
  const mechanism::Vector4 acceleration = rate * (velocity_.once - velocity_.twice);
  settled_s_ += in.dt;
  out_.known = findPose(knowledge, in.position_m) && expect(knowledge, in, acceleration) && parts_.allFinite() &&
               force_.twice.allFinite();
  if (!out_.known) {
    reset();
    return out_;
  }
  out_.friction_N = parts_.friction;
  out_.expected_N = parts_.gravity + parts_.inertia + parts_.friction +
                    in.payload_kg * (parts_.payload_gravity + parts_.payload_inertia);
  out_.residual_N = force_.twice - out_.expected_N;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    out_.moving[i] = std::abs(std::tanh(velocity_.twice[i] / kSlow_m_per_s));
    // Not identified, friction hides in motion as well.
    const double hidden = knowledge.identified ? 1.0 - out_.moving[i] : 1.0;
    out_.hidden_N[i] = hidden * knowledge.coulomb_N[i];
    out_.certain_N[i] = beyond(out_.residual_N[i], out_.hidden_N[i]);
    const double square = out_.rms_N[i] * out_.rms_N[i];
    const double faded = std::min(1.0, in.dt / kRms_s);
    out_.rms_N[i] = std::sqrt(square + faded * (out_.certain_N[i] * out_.certain_N[i] - square));
  }
  if (knowledge.parts.mechanism) {
    out_.jacobian = mechanism::lengthJacobian(*knowledge.parts.mechanism, out_.pose);
    out_.wrench = -out_.jacobian.transpose() * out_.certain_N;
    out_.wrench_band = out_.jacobian.cwiseAbs().transpose() * knowledge.band_N;
  }
  out_.known = settled_s_ >= kSettle_s;
  return out_;
}

}  // namespace knee_robot::control
