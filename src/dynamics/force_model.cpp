#include "force_model.h"

namespace knee_robot::dynamics {

mechanism::Vector4 gainOfForce(const mechanism::Vector4& gain) noexcept {
  return (gain.array() / (1.0 - gain.array())).matrix();
}

SeenForce seenForce(const EffectsSee& see, const ExtendedRegressor& row) noexcept {
  SeenForce seen;
  seen.load.noalias() = row * see.load;
  constexpr int kRubbing = extended::kCoulomb - extended::kPassiveFriction;
  seen.rubbing.noalias() =
      row.middleCols<kRubbing>(extended::kPassiveFriction) * see.rubbing.segment<kRubbing>(extended::kPassiveFriction);
  return seen;
}

SeenForce seenForceOfAxes(const EffectsSee& see, int axes, const mechanism::Vector4& velocity,
                          const mechanism::Vector4& acceleration) noexcept {
  SeenForce seen;
  for (int i = 0; i < axes; ++i) {
    const mechanism::Vector4 row = actuatorRegressor(velocity[i], acceleration[i]);
    seen.load[i] = row.dot(see.axis_load.col(i));
    seen.rubbing[i] = row.dot(see.axis_rubbing.col(i));
  }
  return seen;
}

WithEffects stepEffects(const ForceModel& model, const SeenForce& seen, EffectsInstant& at, MotionMemory& memory,
                        double friction_period_s) noexcept {
  for (int i = 0; i < model.axes; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    memory.friction[axis].fade(at.fade[i]);
    at.share[i] = memory.friction[axis].step(model.friction[axis], at.displacement_m[i], friction_period_s);
  }
  WithEffects out;
  if (!model.effects.any()) return out;
  at.load_N = seen.load;
  out.effects = effectForces(model.effects, model.axes, at, memory);
  const mechanism::Vector4 base = seen.load + seen.rubbing + model.effects.see.coulomb.cwiseProduct(at.share);
  out.without_gain = base + out.effects.sum();
  out.whole = out.without_gain + gainOfForce(model.effects.gain).cwiseProduct(out.without_gain);
  return out;
}

namespace {

mechanism::Motion later(const mechanism::Motion& motion, const mechanism::Vector4& jerk, double t) noexcept {
  mechanism::Motion out = motion;
  out.pose += t * motion.pose_velocity + 0.5 * t * t * motion.pose_acceleration;
  out.pose_velocity += t * motion.pose_acceleration + 0.5 * t * t * jerk;
  out.pose_acceleration += t * jerk;
  return out;
}

EffectsInstant later(const EffectsInstant& at, const MotionMemory& memory, double t) noexcept {
  EffectsInstant out = at;
  out.period_s = t;
  out.displacement_m = t * at.velocity_m_per_s + 0.5 * t * t * memory.acceleration;
  out.position_m += out.displacement_m;
  out.velocity_m_per_s += t * memory.acceleration + 0.5 * t * t * memory.jerk;
  out.fade.setOnes();
  return out;
}

}  // namespace

mechanism::Vector4 forceAhead(const ForceModel& model, const EffectsInstant& at, const mechanism::Vector4& whole,
                              const MotionMemory& memory, RegressorData& workspace, ExtendedRegressor& row) noexcept {
  const double horizon = model.effects.horizon();
  EffectsInstant then = later(at, memory, horizon);
  MotionMemory remembered = memory;
  SeenForce seen;
  mechanism::Motion motion;
  if (model.mechanism) {
    motion = later(*at.motion, *at.pose_per_length * memory.jerk, horizon);
    if (!extendedRegressor(*model.mechanism, model.gravity, motion, workspace, row)) return mechanism::Vector4::Zero();
    seen = seenForce(model.effects.see, row);
    then.motion = &motion;
    then.pose_per_length = &workspace.pose_per_length;
  } else {
    seen = seenForceOfAxes(model.effects.see, model.axes, then.velocity_m_per_s,
                           memory.acceleration + horizon * memory.jerk);
  }
  const WithEffects ahead = stepEffects(model, seen, then, remembered, horizon);
  return (ahead.whole - whole).cwiseProduct(model.effects.ahead_s) / horizon;
}

bool forceFromModel(const ForceModel& model, const mechanism::Vector4& position, const mechanism::Vector4& velocity,
                    const mechanism::Vector4& acceleration, const mechanism::Motion& motion, ForceModelData& data,
                    mechanism::Vector4& forces, double period_s) noexcept {
  mechanism::Vector4 smooth = mechanism::Vector4::Zero();
  EffectsInstant at;
  SeenForce seen;
  if (model.mechanism) {
    if (!extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.row)) return false;
    smooth.noalias() = data.row * model.parameters;
    if (model.effects.any()) seen = seenForce(model.effects.see, data.row);
    at.mechanism = &*model.mechanism;
    at.motion = &motion;
    at.pose_per_length = &data.regressor.pose_per_length;
  } else {
    for (int i = 0; i < model.axes; ++i)
      smooth[i] = actuatorRegressor(velocity[i], acceleration[i]).dot(model.axis_parameters.col(i));
    seen = seenForceOfAxes(model.effects.see, model.axes, velocity, acceleration);
  }
  at.period_s = data.started ? period_s : 0.0;
  at.position_m = position;
  at.velocity_m_per_s = velocity;
  if (data.started) at.displacement_m = position - data.last_position;
  data.memory.follow(acceleration, period_s);
  const WithEffects with = stepEffects(model, seen, at, data.memory, period_s);
  smooth += model.coulomb.cwiseProduct(at.share);
  if (model.effects.any()) {
    smooth += with.effects.sum() + with.whole - with.without_gain;
    if (model.effects.horizon() > 0.0)
      smooth += forceAhead(model, at, with.whole, data.memory, data.regressor, data.row);
  }
  data.last_position = position;
  data.started = true;
  forces = smooth;
  return true;
}

}  // namespace knee_robot::dynamics
