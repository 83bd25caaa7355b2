#pragma once

#include "knee_robot/dynamics/force_parts.h"

namespace knee_robot::dynamics {

/// The baseline's regressor at one instant, times what effects see, N.
struct SeenForce {
  mechanism::Vector4 load = mechanism::Vector4::Zero();     ///< carried by the screws
  mechanism::Vector4 rubbing = mechanism::Vector4::Zero();  ///< viscous, and of the passive joints
};
SeenForce seenForce(const EffectsSee& see, const ExtendedRegressor& row) noexcept;
SeenForce seenForceOfAxes(const EffectsSee& see, int axes, const mechanism::Vector4& velocity,
                          const mechanism::Vector4& acceleration) noexcept;

/// What the effects make of it.
struct WithEffects {
  EffectForces effects;
  mechanism::Vector4 without_gain = mechanism::Vector4::Zero();  ///< seen force and effects
  mechanism::Vector4 whole = mechanism::Vector4::Zero();         ///< the same and gain: what is ahead
};
/// What wrong force constants add to a command, as a share of the force that is wanted: gain / (1 - gain), because a
/// gain is a share of the command, itself included. Gains are at most kMostForceGain.
mechanism::Vector4 gainOfForce(const mechanism::Vector4& gain) noexcept;

/// Steps the friction's memory (at.share is filled) and the effects'. `at` needs all but share and load.
WithEffects stepEffects(const ForceModel& model, const SeenForce& seen, EffectsInstant& at, MotionMemory& memory,
                        double friction_period_s) noexcept;

/// What is to be asked for ahead: the whole force `horizon` later, on the motion as it goes on with its acceleration
/// and jerk, less that of now, by each actuator's share of the horizon. Zero where the mechanism will be singular.
/// `memory`: after the step of now.
mechanism::Vector4 forceAhead(const ForceModel& model, const EffectsInstant& at, const mechanism::Vector4& whole,
                              const MotionMemory& memory, RegressorData& workspace, ExtendedRegressor& row) noexcept;

/// The parts of the baseline with these parameters. `motion` holds the pose; its rates are filled in where something
/// moves. False where the mechanism is singular.
bool smoothParts(const PartedModel& model, const ExtendedParameters& parameters,
                 const mechanism::Matrix4& axis_parameters, const WantedInstant& at, mechanism::Motion& motion,
                 ForcePartsData& data, ForceParts& parts) noexcept;

}  // namespace knee_robot::dynamics
