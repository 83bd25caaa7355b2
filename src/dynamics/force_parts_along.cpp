#include <cmath>

#include "force_model.h"
#include "knee_robot/dynamics/force_parts.h"

namespace knee_robot::dynamics {
namespace {

/// What effects see of the baseline at this instant, and what of it is there at rest.
struct Seen {
  SeenForce force;
  mechanism::Vector4 at_rest = mechanism::Vector4::Zero();
};

Seen seenAt(const ForceModel& model, const WantedInstant& at, const ForcePartsData& data) noexcept {
  Seen seen;
  const EffectsSee& see = model.effects.see;
  if (model.mechanism) {
    seen.force = seenForce(see, data.moves ? data.moving : data.still);
    seen.at_rest = data.still * see.load;
  } else {
    seen.force = seenForceOfAxes(see, model.axes, at.velocity_m_per_s, at.acceleration_m_per_s2);
    seen.at_rest = see.axis_load.row(3).transpose();
  }
  return seen;
}

/// Effects into the parts that they belong to.
void addEffects(const ForceModel& model, const WithEffects& with, const Seen& seen, const mechanism::Vector4& ahead,
                ForceParts& parts) noexcept {
  const mechanism::Vector4 gain = gainOfForce(model.effects.gain);  // of everything, what a wrong force constant adds
  const mechanism::Vector4 carried = seen.at_rest, moving = seen.force.load - seen.at_rest;
  const mechanism::Vector4 effects = with.effects.sum();
  const mechanism::Vector4 rubbing = with.without_gain - effects - seen.force.load;
  parts.gravity += with.effects.carried + gain.cwiseProduct(carried + with.effects.carried);
  parts.inertia += gain.cwiseProduct(moving) + ahead;
  parts.friction += with.effects.friction + gain.cwiseProduct(rubbing + with.effects.friction);
  parts.payload_gravity += gain.cwiseProduct(parts.payload_gravity);
  parts.payload_inertia += gain.cwiseProduct(parts.payload_inertia);
}

mechanism::Vector4 fadeOf(const WantedInstant& at) noexcept {
  mechanism::Vector4 fade = mechanism::Vector4::Ones();
  if (!(at.rest_s > 0.0)) return fade;
  const double kept = std::exp(-at.period_s / at.rest_s);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (at.velocity_m_per_s[i] == 0.0) fade[i] = kept;
  }
  return fade;
}

}  // namespace

bool forceParts(const PartedModel& parted, const mechanism::Pose& pose, const WantedInstant& wanted,
                ForcePartsData& data, ForceParts& parts) noexcept {
  if (!parted.identified) {
    return forceParts(parted, pose, wanted.velocity_m_per_s, wanted.acceleration_m_per_s2, wanted.coulomb_m_per_s, data,
                      parts);
  }
  const ForceModel& model = *parted.identified;
  ForceParts found;
  mechanism::Motion motion;
  motion.pose = pose;
  if (!smoothParts(parted, model.parameters, model.axis_parameters, wanted, motion, data, found)) return false;
  EffectsInstant at;
  at.period_s = wanted.period_s;
  at.position_m = wanted.position_m;
  at.velocity_m_per_s = wanted.velocity_m_per_s;
  at.displacement_m =
      wanted.period_s * (wanted.velocity_m_per_s - 0.5 * wanted.period_s * wanted.acceleration_m_per_s2);
  at.fade = fadeOf(wanted);
  if (model.mechanism) {
    at.mechanism = &*model.mechanism;
    at.motion = &motion;
    at.pose_per_length = &data.regressor.pose_per_length;
  }
  data.memory.follow(wanted.acceleration_m_per_s2, wanted.period_s);
  Seen seen;
  if (model.effects.any()) seen = seenAt(model, wanted, data);
  const WithEffects with = stepEffects(model, seen.force, at, data.memory, wanted.period_s);
  found.friction += model.coulomb.cwiseProduct(at.share);
  if (model.effects.any()) {
    mechanism::Vector4 ahead = mechanism::Vector4::Zero();
    if (data.moves && model.effects.horizon() > 0.0)
      ahead = forceAhead(model, at, with.whole, data.memory, data.later, data.moving);
    addEffects(model, with, seen, ahead, found);
  }
  parts = found;
  return true;
}

void restParts(const PartedModel& model, double duration_s, ForcePartsData& data) noexcept {
  if (model.identified) rest(model.identified->effects, duration_s, data.memory);
}

}  // namespace knee_robot::dynamics
