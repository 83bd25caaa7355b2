#pragma once

#include <array>

#include "knee_robot/dynamics/effect_law.h"

namespace knee_robot::dynamics {

inline constexpr int kOuterLegs = 3;
inline constexpr int kPlatformJointColumns = 6;

/// How the joints between legs and platform turn with the pose (rad per unit of the pose): leg 4's universal joint
/// about Y (theta_4 = theta + q41 - pi/2; its other axis is psi) and the platform beside legs 1 to 3 (spherical joints,
/// base frame).
struct PlatformJoints {
  mechanism::Vector4 about_y;
  std::array<mechanism::Matrix34, kOuterLegs> spherical;
};
void platformJoints(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion,
                    PlatformJoints& out) noexcept;

/// Generalized friction on the pose per unit of its coefficients: Coulomb (N m) and viscous (N m s/rad) of leg 4's
/// universal joint about Y, of the same about psi, and of the spherical joints, which are alike. The paper's eq. (23)
/// has none of them. `slow_rad_per_s`: below it Coulomb friction is proportional to the rate.
void platformJointColumns(const PlatformJoints& joints, const mechanism::Vector4& pose_velocity, double slow_rad_per_s,
                          PoseColumns& out) noexcept;

}  // namespace knee_robot::dynamics
