#pragma once

#include <array>

#include "knee_robot/dynamics/effect_law.h"

namespace knee_robot::dynamics {

inline constexpr int kOuterLegs = 3;
inline constexpr int kPlatformJointColumns = 6, kBaseJointColumns = 4;

/// How the joints without motors turn with the pose (rad per unit of the pose).
struct PassiveJoints {
  mechanism::Vector4 about_y;  ///< leg 4's universal joint at the platform: theta_4 = theta + q41 - pi/2; its other
                               ///< axis is psi
  std::array<mechanism::Matrix34, kOuterLegs> spherical;     ///< the platform beside legs 1 to 3, base frame
  mechanism::Vector4 revolute;                               ///< leg 4's at the base, q41
  std::array<mechanism::Vector4, 2 * kOuterLegs> universal;  ///< of legs 1 to 3 at the base: q11 q12 q21 q22 q31 q32
};
void passiveJoints(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion, PassiveJoints& out) noexcept;

/// How dry friction of these joints builds up near rest.
struct JointRestLaw {
  double slow_rad_per_s = 0.0;  ///< proportional to the rate below it; unused with bristles
  double bristle_rad = 0.0;     ///< 0: none; otherwise the angle over which bristles bend (Dahl), whatever the rate
};

/// Generalized friction on the pose per unit of its coefficients: Coulomb (N m) and viscous (N m s/rad) of leg 4's
/// universal joint about Y, of the same about psi, and of the spherical joints, which are alike. The paper's eq. (23)
/// has none of them. To be called once per instant, in order of time, `period_s` after the one before.
void platformJointColumns(const PassiveJoints& joints, const mechanism::Vector4& pose_velocity,
                          const JointRestLaw& rest, double period_s, JointMemory& memory, PoseColumns& out) noexcept;

/// The same of the joints at the base, which eq. (22) and (23) have: leg 4's revolute joint, and the universal joints of
/// legs 1 to 3, whose six axes are alike.
void baseJointColumns(const PassiveJoints& joints, const mechanism::Vector4& pose_velocity, const JointRestLaw& rest,
                      double period_s, JointMemory& memory, PoseColumns& out) noexcept;

}  // namespace knee_robot::dynamics
