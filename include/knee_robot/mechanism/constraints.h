#pragma once

#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::mechanism {

/// Numbers of generalized coordinates and of constraint equations, eq. (2)-(3): 15 - 11 = 4 degrees of freedom.
inline constexpr int kCoordinates = 15;
inline constexpr int kConstraints = 11;

/// In the paper's order (14): q13 q12 q11 q23 q22 q21 q33 q32 q31 q42 q41 psi theta Zm Xm (m and rad).
using Coordinates = Eigen::Matrix<double, kCoordinates, 1>;
using ConstraintVector = Eigen::Matrix<double, kConstraints, 1>;
using ConstraintJacobian = Eigen::Matrix<double, kConstraints, kCoordinates>;
using DependentJacobian = Eigen::Matrix<double, kConstraints, kLegs>;

/// Places of the four actuated coordinates, eq. (20), and of the eleven dependent ones, eq. (21), counted from 0.
inline constexpr std::array<int, kLegs> kIndependent = {0, 3, 6, 9};
inline constexpr std::array<int, kConstraints> kDependent = {1, 2, 4, 5, 7, 8, 10, 11, 12, 13, 14};

/// Values, velocities and accelerations of all 15 coordinates.
struct CoordinateMotion {
  Coordinates position, velocity, acceleration;
};
/// From the platform's motion, consistent with the constraints by construction. Real-time safe.
CoordinateMotion coordinateMotion(const Mechanism& mechanism, const Motion& motion);
/// Pose, or any other quantity of that order, out of 15 coordinates.
Vector4 poseOf(const Coordinates& coordinates);
/// (q13, q23, q33, q42) out of 15 coordinates, for the check below.
Vector4 lengthsOf(const Coordinates& coordinates);

/// The closure equations (4) of legs 1 to 3 (x, y, z each) and (10) of leg 4 (x, z): leg's tip minus platform's point
/// (m).
/// Zero when the mechanism is assembled; the coordinates need not be consistent. Real-time safe.
ConstraintVector constraints(const Mechanism& mechanism, const Coordinates& q);
/// A = d(constraints)/dq, eq. (12)-(13).
ConstraintJacobian constraintJacobian(const Mechanism& mechanism, const Coordinates& q);
/// b of eq. (15)-(16): the constraints hold on acceleration level when A qdd = b; b = -dA/dt qd.
ConstraintVector constraintBias(const Mechanism& mechanism, const Coordinates& q, const Coordinates& velocity);

// The paper's way from the actuators' motion to all others: used as an independent check of the closed forms with which
// this package calculates (leg_motion.h).

/// X of eq. (19): dependent velocities are -X times the actuator velocities; X = A_d^-1 A_i. False when A_d is singular
/// (type II: the actuators do not determine the motion). Real-time safe.
bool dependentJacobian(const Mechanism& mechanism, const Coordinates& q, DependentJacobian& x);

/// All velocities and accelerations from those of the actuators at assembled coordinates, through A and b. False when
/// A_d is singular. Real-time safe.
bool coordinateRates(const Mechanism& mechanism, const Coordinates& q, const Vector4& length_velocity,
                     const Vector4& length_acceleration, Coordinates& velocity, Coordinates& acceleration);

}  // namespace knee_robot::mechanism
