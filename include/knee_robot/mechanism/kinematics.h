#pragma once

#include <limits>

#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::mechanism {

/// Platform pose x = (Xm, Zm, theta, psi): metres and radians, base frame; rotation by eq. (5).
using Pose = Vector4;
/// Actuated lengths (q13, q23, q33, q42) in m.
using Lengths = Vector4;

/// 0Rm of eq. (5): theta about Y, then psi about the turned Z.
Matrix3 platformRotation(const Pose& pose);

/// All eleven joint coordinates of the legs. Legs 1 to 3: q1 and q2 of the universal joint (rad), q3 the length (m),
/// eq. (7)-(9); leg 4: q41 (rad), q42 the length (m), eq. (10)-(11).
struct JointCoordinates {
  std::array<double, 3> q1{};
  std::array<double, 3> q2{};
  std::array<double, 3> q3{};
  double q41 = 0.0;
  double q42 = 0.0;

  Lengths lengths() const { return {q3[0], q3[1], q3[2], q42}; }
};

/// Unique solution in the working branch (all lengths positive, -pi/2 < q2 < pi/2). Real-time safe.
JointCoordinates inverseKinematics(const Mechanism& mechanism, const Pose& pose);

/// Only the four lengths. Real-time safe.
Lengths legLengths(const Mechanism& mechanism, const Pose& pose);

/// J = dq/dx, 4 x 4 (rows: legs; columns: Xm, Zm in m, theta, psi in rad). Real-time safe.
Matrix4 lengthJacobian(const Mechanism& mechanism, const Pose& pose);

/// d/dt of lengthJacobian along poseVelocity, times poseVelocity: qdd = J xdd + this. Real-time safe.
Vector4 lengthBias(const Mechanism& mechanism, const Pose& pose, const Vector4& pose_velocity);

enum class ForwardStatus {
  Converged,
  NotConverged,  ///< Newton did not reach the tolerance: no such pose near the guess
  NearSingular,  ///< converged, but the Jacobian's condition exceeds 1e6: the branch cannot be trusted
  InvalidInput,  ///< a length is not finite or not positive
};

/// Where forward kinematics arrived, and how well.
struct ForwardResult {
  ForwardStatus status = ForwardStatus::InvalidInput;
  Pose pose = Pose::Zero();  ///< meaningful only when converged
  int iterations = 0;
  double residual_m = 0.0;  ///< largest length error that is left
  /// How near a singularity the pose is, at no extra cost: conditionNumber() lies between a quarter of this bound and
  /// the bound.
  double condition_bound = std::numeric_limits<double>::infinity();
  bool ok() const { return status == ForwardStatus::Converged; }
};

/// Pose with these actuated lengths on the assembly branch of `guess`, by Newton with step limitation. Never returns a
/// wrong answer as converged: residual below 1e-11 m, or another status. Real-time safe, bounded iterations.
ForwardResult forwardKinematics(const Mechanism& mechanism, const Lengths& lengths, const Pose& guess);

/// The assembly branch in which the robot was built (platform above the base, level): the pose at these lengths found
/// from a level pose over the base, for a caller without history. Same statuses.
ForwardResult forwardKinematicsFromHome(const Mechanism& mechanism, const Lengths& lengths);

/// Condition number of J (m, rad), the singularity measure of the robot file's `condition_max`. Infinite when singular.
double conditionNumber(const Mechanism& mechanism, const Pose& pose);

/// Pose velocity and acceleration with these actuator velocities and accelerations (m/s, m/s^2). False when J is
/// singular to working precision; then the outputs are not touched. Real-time safe.
bool poseRates(const Mechanism& mechanism, const Pose& pose, const Vector4& length_velocity,
               const Vector4& length_acceleration, Vector4& pose_velocity, Vector4& pose_acceleration);

/// Angles (rad) of each joint from its neutral axis: see JointLimits. Leg 4 has no spherical joint: its entry is 0.
struct JointAngles {
  std::array<double, kLegs> base{};      ///< universal (legs 1 to 3), revolute (leg 4)
  std::array<double, kLegs> platform{};  ///< spherical (legs 1 to 3)
};
JointAngles jointAngles(const Mechanism& mechanism, const Pose& pose);

}  // namespace knee_robot::mechanism
