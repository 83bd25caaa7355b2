#pragma once

#include <array>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

/// Platform pose with its first and second time derivative (m, rad, s).
struct Motion {
  Pose pose = Pose::Zero();
  Vector4 pose_velocity = Vector4::Zero();
  Vector4 pose_acceleration = Vector4::Zero();
};

/// One leg at one instant. Its two bodies (cylinder and rod) share one orientation, described by the right-handed leg
/// basis
/// (-t, u, n): u along the leg from base to platform, n the axis of the joint next to the cylinder, t = n x u.
/// Legs 1 to 3: q1 turns about the base's -Y, q2 about n = (-sin q1, 0, cos q1). Leg 4 has q2 alone, named q41 in the
/// paper, about n = -Y; its q1 entries are zero.
struct LegMotion {
  Vector3 u, n, t;                    ///< base frame, unit vectors
  double length = 0.0;                ///< m, u = (tip - base joint) / length
  double sin_q2 = 0.0, cos_q2 = 1.0;  ///< of the paper's q2; 0 and 1 for leg 4
  Vector3 rate;                       ///< d/dt (q1, q2, q3), rad/s and m/s
  Vector3 acceleration;               ///< d2/dt2 (q1, q2, q3)
  Vector3 tip_acceleration;           ///< of the platform joint, base frame, m/s^2
  Matrix34 tip_per_pose;              ///< d(tip)/d(pose), base frame
  Matrix34 joints_per_pose;           ///< d(q1, q2, q3)/d(pose); row q1 is zero for leg 4
};

/// The platform at one instant.
struct PlatformMotion {
  Matrix3 rotation;      ///< 0Rm
  Vector3 omega;         ///< angular velocity, base frame
  Vector3 alpha;         ///< angular acceleration, base frame
  Vector3 acceleration;  ///< of the platform's origin, base frame
};

/// Everything that moves, from the platform's motion; closed form, real-time safe.
struct RobotMotion {
  std::array<LegMotion, kLegs> legs;
  PlatformMotion platform;
  Matrix4 jacobian;  ///< dq/dx, equal to lengthJacobian()

  Vector4 lengthVelocity() const { return {legs[0].rate[2], legs[1].rate[2], legs[2].rate[2], legs[3].rate[2]}; }
  Vector4 lengthAcceleration() const {
    return {legs[0].acceleration[2], legs[1].acceleration[2], legs[2].acceleration[2], legs[3].acceleration[2]};
  }
};
void robotMotion(const Mechanism& mechanism, const Motion& motion, RobotMotion& out);

/// Platform motion from actuated lengths (m), velocities and accelerations, by forward kinematics from `guess`.
/// `motion` is written only when the result is ForwardStatus::Converged. Real-time safe.
ForwardStatus motionFromLengths(const Mechanism& mechanism, const Lengths& lengths, const Vector4& length_velocity,
                                const Vector4& length_acceleration, const Pose& guess, Motion& motion);

/// Values of the URDF's moving joints that draw this pose, with their names in the same order: q11 q12 q13 q21 q22 q23
/// q31 q32 q33 q41 q42 (as in the paper), theta_4 = theta + q41 - pi/2 and psi_4 = psi (universal joint of leg 4, which
/// carries the platform). Angles in rad, lengths in m.
inline constexpr int kUrdfJoints = 13;
const std::array<const char*, kUrdfJoints>& urdfJointNames();
std::array<double, kUrdfJoints> urdfJointPositions(const Mechanism& mechanism, const Pose& pose);

}  // namespace knee_robot::mechanism
