#include "knee_robot/mechanism/constraints.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace knee_robot::mechanism {
namespace {

/// Leg i's axis u and its partial derivatives by q1 (c2 n) and q2 (t), from the joint angles, eq. (7)-(11).
struct LegAxis {
  LegAxis(const Coordinates& q, int i) : length(q[3 * i]) {
    const double q1 = i == 3 ? q[10] : q[3 * i + 2], q2 = i == 3 ? 0.0 : q[3 * i + 1];
    c2 = std::cos(q2);
    s2 = std::sin(q2);
    const double c1 = std::cos(q1), s1 = std::sin(q1);
    u = Vector3(c1 * c2, s2, s1 * c2);
    n = Vector3(-s1, 0.0, c1);
    t = Vector3(-c1 * s2, c2, -s1 * s2);
  }
  double length, c2, s2;
  Vector3 u, n, t;
};

Pose poseIn(const Coordinates& q) {
  return {q[14], q[13], q[12], q[11]};
}

}  // namespace

CoordinateMotion coordinateMotion(const Mechanism& mechanism, const Motion& motion) {
  RobotMotion all;
  robotMotion(mechanism, motion, all);
  const JointCoordinates q = inverseKinematics(mechanism, motion.pose);
  CoordinateMotion result;
  for (int i = 0; i < 3; ++i) {
    result.position.segment<3>(3 * i) << q.q3[i], q.q2[i], q.q1[i];
    result.velocity.segment<3>(3 * i) = all.legs[i].rate.reverse();
    result.acceleration.segment<3>(3 * i) = all.legs[i].acceleration.reverse();
  }
  result.position.segment<2>(9) << q.q42, q.q41;
  // Row 1 of leg 4 is its q41: see LegMotion.
  result.velocity.segment<2>(9) << all.legs[3].rate[2], all.legs[3].rate[1];
  result.acceleration.segment<2>(9) << all.legs[3].acceleration[2], all.legs[3].acceleration[1];
  result.position.tail<4>() = motion.pose.reverse();
  result.velocity.tail<4>() = motion.pose_velocity.reverse();
  result.acceleration.tail<4>() = motion.pose_acceleration.reverse();
  return result;
}

Vector4 poseOf(const Coordinates& coordinates) {
  return poseIn(coordinates);
}

Vector4 lengthsOf(const Coordinates& q) {
  return {q[0], q[3], q[6], q[9]};
}

ConstraintVector constraints(const Mechanism& mechanism, const Coordinates& q) {
  const Pose pose = poseIn(q);
  const Matrix3 rotation = platformRotation(pose);
  const Vector3 origin(pose[0], 0.0, pose[1]);
  ConstraintVector f;
  for (int i = 0; i < kLegs; ++i) {
    const LegAxis leg(q, i);
    const Vector3 gap =
        mechanism.base_points[i] + leg.length * leg.u - origin - rotation * mechanism.platform_points[i];
    if (i < 3) {
      f.segment<3>(3 * i) = gap;
    } else {
      f.segment<2>(9) << gap.x(), gap.z();  // y is zero whatever the coordinates: eq. (10)
    }
  }
  return f;
}

ConstraintJacobian constraintJacobian(const Mechanism& mechanism, const Coordinates& q) {
  const Pose pose = poseIn(q);
  const Matrix3 rotation = platformRotation(pose);
  ConstraintJacobian a = ConstraintJacobian::Zero();
  for (int i = 0; i < 3; ++i) {
    const LegAxis leg(q, i);
    const Vector3 arm = rotation * mechanism.platform_points[i];
    auto rows = a.middleRows<3>(3 * i);
    rows.col(3 * i) = leg.u;
    rows.col(3 * i + 1) = leg.length * leg.t;
    rows.col(3 * i + 2) = leg.length * leg.c2 * leg.n;
    rows.col(11) = -rotation.col(2).cross(arm);
    rows.col(12) = -Vector3(arm.z(), 0.0, -arm.x());
    rows.col(13) = -Vector3::UnitZ();
    rows.col(14) = -Vector3::UnitX();
  }
  const LegAxis leg(q, 3);
  a.block<2, 1>(9, 9) << leg.u.x(), leg.u.z();
  a.block<2, 1>(9, 10) << leg.length * leg.n.x(), leg.length * leg.n.z();
  a(10, 13) = -1.0;
  a(9, 14) = -1.0;
  return a;
}

ConstraintVector constraintBias(const Mechanism& mechanism, const Coordinates& q, const Coordinates& velocity) {
  const Pose pose = poseIn(q), rate = poseIn(velocity);
  const Matrix3 rotation = platformRotation(pose);
  const Vector3 normal = rotation.col(2);
  const Vector3 omega = rate[2] * Vector3::UnitY() + rate[3] * normal;
  const Vector3 alpha = rate[2] * rate[3] * Vector3(normal.z(), 0.0, -normal.x());
  ConstraintVector b;
  for (int i = 0; i < kLegs; ++i) {
    const LegAxis leg(q, i);
    const double v1 = i == 3 ? velocity[10] : velocity[3 * i + 2], v2 = i == 3 ? 0.0 : velocity[3 * i + 1];
    const double v3 = velocity[3 * i], swing = leg.c2 * v1;
    // What the tip accelerates by although all joint accelerations are zero (e = c2 u - s2 t, see leg_motion.cpp).
    const Vector3 tip = -leg.length * (swing * swing + v2 * v2) * leg.u +
                        (leg.length * leg.s2 * swing * v1 + 2.0 * v3 * v2) * leg.t +
                        (2.0 * v3 * swing - 2.0 * leg.length * leg.s2 * v1 * v2) * leg.n;
    const Vector3 arm = rotation * mechanism.platform_points[i];
    const Vector3 platform = alpha.cross(arm) + omega.cross(omega.cross(arm));
    if (i < 3) {
      b.segment<3>(3 * i) = platform - tip;
    } else {
      b.segment<2>(9) << -tip.x(), -tip.z();
    }
  }
  return b;
}

namespace {

using Dependent = Eigen::Matrix<double, kConstraints, kConstraints>;

void splitJacobian(const ConstraintJacobian& a, Dependent& dependent, DependentJacobian& independent) {
  for (int k = 0; k < kConstraints; ++k)
    dependent.col(k) = a.col(kDependent[k]);
  for (int k = 0; k < kLegs; ++k)
    independent.col(k) = a.col(kIndependent[k]);
}

bool singular(const Eigen::PartialPivLU<Dependent>& lu) {
  const ConstraintVector pivots = lu.matrixLU().diagonal().cwiseAbs();
  return !(pivots.minCoeff() > 1e-13 * pivots.maxCoeff());
}

}  // namespace

bool dependentJacobian(const Mechanism& mechanism, const Coordinates& q, DependentJacobian& x) {
  Dependent dependent;
  DependentJacobian independent;
  splitJacobian(constraintJacobian(mechanism, q), dependent, independent);
  const Eigen::PartialPivLU<Dependent> lu(dependent);
  if (singular(lu)) return false;
  x = lu.solve(independent);
  return true;
}

bool coordinateRates(const Mechanism& mechanism, const Coordinates& q, const Vector4& length_velocity,
                     const Vector4& length_acceleration, Coordinates& velocity, Coordinates& acceleration) {
  Dependent dependent;
  DependentJacobian independent;
  splitJacobian(constraintJacobian(mechanism, q), dependent, independent);
  const Eigen::PartialPivLU<Dependent> lu(dependent);
  if (singular(lu)) return false;
  const auto fill = [](const Vector4& free, const ConstraintVector& bound, Coordinates& all) {
    for (int k = 0; k < kLegs; ++k)
      all[kIndependent[k]] = free[k];
    for (int k = 0; k < kConstraints; ++k)
      all[kDependent[k]] = bound[k];
  };
  const ConstraintVector bound_velocity = lu.solve(-independent * length_velocity);
  fill(length_velocity, bound_velocity, velocity);
  const ConstraintVector bias = constraintBias(mechanism, q, velocity);
  const ConstraintVector bound_acceleration = lu.solve(bias - independent * length_acceleration);
  fill(length_acceleration, bound_acceleration, acceleration);
  return true;
}

}  // namespace knee_robot::mechanism
