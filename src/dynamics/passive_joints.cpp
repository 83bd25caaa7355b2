#include "knee_robot/dynamics/passive_joints.h"

#include <cmath>

namespace knee_robot::dynamics {
namespace {

using mechanism::Matrix34;
using mechanism::Vector3;
using mechanism::Vector4;

void addAxis(const Vector4& turning, const Vector4& velocity, double slow, PoseColumns& out, int column) noexcept {
  const double rate = turning.dot(velocity);
  out.col(column) += rate / std::hypot(rate, slow) * turning;
  out.col(column + 1) += rate * turning;
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

void platformJointColumns(const PassiveJoints& joints, const Vector4& velocity, double slow_rad_per_s,
                          PoseColumns& out) noexcept {
  out.leftCols<kPlatformJointColumns>().setZero();
  addAxis(joints.about_y, velocity, slow_rad_per_s, out, 0);
  addAxis(Vector4::UnitW(), velocity, slow_rad_per_s, out, 2);
  for (const Matrix34& turning : joints.spherical) {
    const Vector3 rate = turning * velocity;
    const Vector4 viscous = turning.transpose() * rate;
    out.col(4) += viscous / std::sqrt(rate.squaredNorm() + slow_rad_per_s * slow_rad_per_s);
    out.col(5) += viscous;
  }
}

void baseJointColumns(const PassiveJoints& joints, const Vector4& velocity, double slow_rad_per_s,
                      PoseColumns& out) noexcept {
  out.leftCols<kBaseJointColumns>().setZero();
  addAxis(joints.revolute, velocity, slow_rad_per_s, out, 0);
  for (const Vector4& axis : joints.universal)
    addAxis(axis, velocity, slow_rad_per_s, out, 2);
}

}  // namespace knee_robot::dynamics
