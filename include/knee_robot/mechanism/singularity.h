#pragma once

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {

/// How near a pose is to the mechanism's singularities.
///
/// Type I (a leg loses a direction of its tip): the closure equations' part in the leg coordinates is singular, when a
/// length or cos(q2) of a universal joint is zero. Type II (the platform moves although all actuators are locked, and
/// no actuator force can resist): J = dq/dx, equivalently A_d of eq. (21), is singular.
struct Singularity {
  /// Determinant of the 11 x 11 part in the leg coordinates, divided by powers of the lengths: cos q12 cos q22 cos q32.
  double type_one = 0.0;
  double determinant = 0.0;  ///< det J, m^2/rad^2; its sign names the assembly mode
  double condition = 0.0;    ///< of J (m, rad): conditionNumber()
  double scaled_condition =
      0.0;  ///< of J with angles times the characteristic length: does not change with the unit of length
  double dependent_condition = 0.0;  ///< of A_d, 11 x 11 (m, rad)
  /// Largest actuator force (N, Euclidean norm over the four) that 1 N, or 1 N times the characteristic length, at the
  /// platform can need: 1 / smallest singular value of the scaled J.
  double force_amplification = 0.0;
};

/// Length that turns the platform's angles into distances: mean radius of its three joints (m).
double characteristicLength(const Mechanism& mechanism);

/// All measures at a pose; infinite conditions where singular. Some tens of microseconds (singular values of an 11 x 11
/// matrix); nothing allocates. In a control loop use conditionNumber().
Singularity singularityAt(const Mechanism& mechanism, const Pose& pose);

/// How much the actuator lengths (m, Euclidean norm over the four) would have to change until two assembly modes meet,
/// to second order: s^2 / (2 |c|) with s the smallest singular value of the scaled J and c its slope along its own
/// direction. Two poses have the lengths of a pose near such a fold; when the geometry is known less exactly than this
/// distance, lengths alone do not tell on which of them the robot stands. Large far from singularities. Real-time safe.
double foldDistance(const Mechanism& mechanism, const Pose& pose);

}  // namespace knee_robot::mechanism
