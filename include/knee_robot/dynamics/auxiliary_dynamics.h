#pragma once

#include "knee_robot/dynamics/force_parts.h"

namespace knee_robot::dynamics {

/// A motion for inverse dynamics with an auxiliary velocity; per actuator.
struct AuxiliaryMotion {
  mechanism::Vector4 velocity = mechanism::Vector4::Zero();      ///< q', m/s: of the mechanism
  mechanism::Vector4 reference = mechanism::Vector4::Zero();     ///< q'_r, m/s: the auxiliary one
  mechanism::Vector4 acceleration = mechanism::Vector4::Zero();  ///< q''_r, m/s^2
};

/// Workspace: make one and keep it.
struct AuxiliaryData {
  RegressorData regressor;
  ExtendedRegressor row;
};

/// Actuator forces (N), without gravity and dry friction:
///
///     M(q) q''_r + C(q, q') q'_r + V(q) q'_r          V: viscous friction of actuators and passive joints
///
/// with C of Christoffel's symbols in the actuators' lengths, for which dM/dt - 2C is skew-symmetric whatever the
/// parameters are. C is never written down. A velocity force h(v) that is quadratic in v has one symmetric bilinear
/// form, h(v, w) = C(v) w, and polarization gives it, so that with D(v, a), the inverse dynamics of the identified
/// parameters at this pose,
///
///     result = D((q' + q'_r) / 2, q''_r) - D((q' - q'_r) / 2, 0).
///
/// Gravity and offsets cancel, what is linear in the velocity comes out at q'_r, and two regressors are all it takes:
/// nothing but linear parameters is needed, physically possible or not. With q'_r = q' it is the ordinary inverse
/// dynamics. False, with `forces` untouched, where the mechanism is singular. Real-time safe.
bool auxiliaryForces(const PartedModel& model, const mechanism::Pose& pose, const AuxiliaryMotion& motion,
                     AuxiliaryData& data, mechanism::Vector4& forces) noexcept;

}  // namespace knee_robot::dynamics
