#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {
namespace {

/// What the kinematics of one pose share: the platform's turned axes and points.
struct Placement {
  Placement(const Mechanism& mechanism, const Pose& pose) : rotation(platformRotation(pose)) {
    const Vector3 origin(pose[0], 0.0, pose[1]);
    for (int i = 0; i < kLegs; ++i) {
      arm[i].noalias() = rotation * mechanism.platform_points[i];
      leg[i] = origin + arm[i] - mechanism.base_points[i];
    }
  }
  Matrix3 rotation;
  std::array<Vector3, kLegs> arm;  // platform origin to joint, base frame
  std::array<Vector3, kLegs> leg;  // base joint to platform joint, base frame
};

/// Velocity of a platform point at `arm` per unit pose velocity, column theta: Y x arm; column psi: (turned Z) x arm.
Vector3 perTheta(const Vector3& arm) {
  return {arm.z(), 0.0, -arm.x()};
}
Vector3 perPsi(const Matrix3& rotation, const Vector3& arm) {
  return rotation.col(2).cross(arm);
}

}  // namespace

Matrix3 platformRotation(const Pose& pose) {
  const double ct = std::cos(pose[2]), st = std::sin(pose[2]), cp = std::cos(pose[3]), sp = std::sin(pose[3]);
  Matrix3 rotation;
  rotation << cp * ct, -sp * ct, st,  //
      sp, cp, 0.0,                    //
      -cp * st, sp * st, ct;
  return rotation;
}

JointCoordinates inverseKinematics(const Mechanism& mechanism, const Pose& pose) {
  const Placement at(mechanism, pose);
  JointCoordinates joints;
  for (int i = 0; i < 3; ++i) {
    const Vector3& d = at.leg[i];
    joints.q1[i] = std::atan2(d.z(), d.x());
    joints.q2[i] = std::atan2(d.y(), std::hypot(d.x(), d.z()));
    joints.q3[i] = d.norm();
  }
  joints.q41 = std::atan2(at.leg[3].z(), at.leg[3].x());
  joints.q42 = at.leg[3].norm();
  return joints;
}

Lengths legLengths(const Mechanism& mechanism, const Pose& pose) {
  const Placement at(mechanism, pose);
  return {at.leg[0].norm(), at.leg[1].norm(), at.leg[2].norm(), at.leg[3].norm()};
}

Matrix4 lengthJacobian(const Mechanism& mechanism, const Pose& pose) {
  const Placement at(mechanism, pose);
  Matrix4 jacobian;
  for (int i = 0; i < kLegs; ++i) {
    const Vector3 direction = at.leg[i].normalized();
    jacobian(i, 0) = direction.x();
    jacobian(i, 1) = direction.z();
    jacobian(i, 2) = direction.dot(perTheta(at.arm[i]));
    jacobian(i, 3) = direction.dot(perPsi(at.rotation, at.arm[i]));
  }
  return jacobian;
}

Vector4 lengthBias(const Mechanism& mechanism, const Pose& pose, const Vector4& pose_velocity) {
  const Placement at(mechanism, pose);
  const double theta_rate = pose_velocity[2], psi_rate = pose_velocity[3];
  const Vector3 normal = at.rotation.col(2);
  const Vector3 omega = theta_rate * Vector3::UnitY() + psi_rate * normal;
  // d(omega)/dt at zero pose acceleration: only the psi axis turns, with theta.
  const Vector3 alpha = theta_rate * psi_rate * perTheta(normal);
  Vector4 bias;
  for (int i = 0; i < kLegs; ++i) {
    const Vector3 turning = omega.cross(at.arm[i]);
    const Vector3 velocity = Vector3(pose_velocity[0], 0.0, pose_velocity[1]) + turning;
    const Vector3 acceleration = alpha.cross(at.arm[i]) + omega.cross(turning);
    const double length = at.leg[i].norm();
    const Vector3 direction = at.leg[i] / length;
    const double along = direction.dot(velocity);
    bias[i] = direction.dot(acceleration) + (velocity.squaredNorm() - along * along) / length;
  }
  return bias;
}

double conditionNumber(const Mechanism& mechanism, const Pose& pose) {
  const Eigen::JacobiSVD<Matrix4> svd(lengthJacobian(mechanism, pose));
  const auto& values = svd.singularValues();
  // Below rounding of the largest singular value nothing is known about the smallest.
  const bool singular = !(values[3] > 8.0 * std::numeric_limits<double>::epsilon() * values[0]);
  return singular ? std::numeric_limits<double>::infinity() : values[0] / values[3];
}

bool poseRates(const Mechanism& mechanism, const Pose& pose, const Vector4& length_velocity,
               const Vector4& length_acceleration, Vector4& pose_velocity, Vector4& pose_acceleration) {
  const Matrix4 jacobian = lengthJacobian(mechanism, pose);
  const Eigen::PartialPivLU<Matrix4> lu(jacobian);
  const Vector4 pivots = lu.matrixLU().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > 1e-13 * pivots.maxCoeff())) return false;
  const Vector4 velocity = lu.solve(length_velocity);
  pose_acceleration = lu.solve(length_acceleration - lengthBias(mechanism, pose, velocity));
  pose_velocity = velocity;
  return true;
}

JointAngles jointAngles(const Mechanism& mechanism, const Pose& pose) {
  const Placement at(mechanism, pose);
  const Vector3 normal = at.rotation.col(2);
  // atan2 keeps its precision at small angles, where acos loses half of it.
  const auto between = [](const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); };
  JointAngles angles;
  for (int i = 0; i < kLegs; ++i) {
    angles.base[i] = between(at.leg[i], Vector3::UnitZ());
    if (i < 3) angles.platform[i] = between(at.leg[i], normal);
  }
  return angles;
}

}  // namespace knee_robot::mechanism
