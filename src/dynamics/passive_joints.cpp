#include "knee_robot/dynamics/passive_joints.h"

#include <cmath>

namespace knee_robot::dynamics {
namespace {

using mechanism::Matrix34;
using mechanism::Vector3;
using mechanism::Vector4;

/// Of an axis that turns with `rate`, and has turned by `turned_rad` since the instant before.
double shareOf(double rate, const JointRestLaw& rest, double turned_rad, double& bent) noexcept {
  if (!(rest.bristle_rad > 0.0)) return rate / std::hypot(rate, rest.slow_rad_per_s);
  const double full = std::copysign(1.0, turned_rad);
  bent = full + (bent - full) * std::exp(-std::abs(turned_rad) / rest.bristle_rad);
  return bent;
}

/// The same of a joint that turns about any axis: a vector in place of a sign. `bent`: three numbers.
Vector3 shareOf(const Vector3& rate, const JointRestLaw& rest, const Vector3& turned_rad, double* bent) noexcept {
  if (!(rest.bristle_rad > 0.0)) return rate / std::hypot(rate.norm(), rest.slow_rad_per_s);
  Eigen::Map<Vector3> share(bent);
  const double angle = turned_rad.norm();
  if (angle > 0.0) {
    const Vector3 full = turned_rad / angle;
    share = full + (share - full) * std::exp(-angle / rest.bristle_rad);
  }
  return share;
}

/// `moved`: the pose since the instant before.
void addAxis(const Vector4& turning, const Vector4& velocity, const JointRestLaw& rest, const Vector4& moved,
             double& bent, PoseColumns& out, int column) noexcept {
  const double rate = turning.dot(velocity);
  out.col(column) += shareOf(rate, rest, turning.dot(moved), bent) * turning;
  out.col(column + 1) += rate * turning;
}

Vector4 movedSince(const Vector4& velocity, double period_s, JointMemory& memory) noexcept {
  const Vector4 moved = 0.5 * period_s * (memory.pose_velocity + velocity);
  memory.pose_velocity = velocity;
  return moved;
}

}  // namespace

void passiveJoints(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion,
                   PassiveJoints& out) noexcept {
  mechanism::RobotMotion robot;
  mechanism::robotMotion(mechanism, motion, robot);
  out.revolute = robot.legs[kOuterLegs].joints_per_pose.row(1).transpose();
  out.about_y = Vector4::UnitZ() + out.revolute;
  Matrix34 platform = Matrix34::Zero();
  platform.col(2) = Vector3::UnitY();
  platform.col(3) = robot.platform.rotation.col(2);
  for (std::size_t i = 0; i < kOuterLegs; ++i) {
    const mechanism::LegMotion& leg = robot.legs[i];
    out.universal[2 * i] = leg.joints_per_pose.row(0).transpose();
    out.universal[2 * i + 1] = leg.joints_per_pose.row(1).transpose();
    out.spherical[i] = platform + Vector3::UnitY() * leg.joints_per_pose.row(0) - leg.n * leg.joints_per_pose.row(1);
  }
}

void platformJointColumns(const PassiveJoints& joints, const Vector4& velocity, const JointRestLaw& rest,
                          double period_s, JointMemory& memory, PoseColumns& out) noexcept {
  out.leftCols<kPlatformJointColumns>().setZero();
  const Vector4 moved = movedSince(velocity, period_s, memory);
  addAxis(joints.about_y, velocity, rest, moved, memory.bent[0], out, 0);
  addAxis(Vector4::UnitW(), velocity, rest, moved, memory.bent[1], out, 2);
  for (std::size_t i = 0; i < kOuterLegs; ++i) {
    const Matrix34& turning = joints.spherical[i];
    const Vector3 rate = turning * velocity;
    out.col(4) += turning.transpose() * shareOf(rate, rest, Vector3(turning * moved), &memory.bent[2 + 3 * i]);
    out.col(5) += turning.transpose() * rate;
  }
}

void baseJointColumns(const PassiveJoints& joints, const Vector4& velocity, const JointRestLaw& rest, double period_s,
                      JointMemory& memory, PoseColumns& out) noexcept {
  out.leftCols<kBaseJointColumns>().setZero();
  const Vector4 moved = movedSince(velocity, period_s, memory);
  addAxis(joints.revolute, velocity, rest, moved, memory.bent[0], out, 0);
  for (std::size_t i = 0; i < joints.universal.size(); ++i)
    addAxis(joints.universal[i], velocity, rest, moved, memory.bent[1 + i], out, 2);
}

}  // namespace knee_robot::dynamics
