#include "knee_robot/mechanism/leg_distance.h"

#include <Eigen/Geometry>

namespace knee_robot::mechanism {
namespace {

constexpr double kNoDistance_m = 1e-9;

using PointByPose = Eigen::Matrix<double, 3, 4>;

struct PointOfLeg {
  Vector3 at;  // m, base frame
  PointByPose by_pose;
  double length_m = 0.0;  // of the leg
  Vector4 length_by_pose;
};

PointOfLeg pointOf(const Mechanism& mechanism, const Pose& pose, const Matrix3& rotation, int leg,
                   const LegPair& pair) noexcept {
  const std::size_t i = static_cast<std::size_t>(leg);
  const Vector3 arm = rotation * mechanism.platform_points[i];
  const Vector3 joint = Vector3(pose[0], 0.0, pose[1]) + arm;
  PointByPose joint_by_pose;
  joint_by_pose.col(0) = Vector3::UnitX();
  joint_by_pose.col(1) = Vector3::UnitZ();
  joint_by_pose.col(2) = Vector3::UnitY().cross(arm);
  joint_by_pose.col(3) = rotation.col(2).cross(arm);
  const Vector3 span = joint - mechanism.base_points[i];
  PointOfLeg out;
  out.length_m = span.norm();
  const Vector3 along = span / out.length_m;
  out.length_by_pose = joint_by_pose.transpose() * along;
  const PointByPose turns = (joint_by_pose - along * out.length_by_pose.transpose()) * (pair.at_m / out.length_m);
  const bool below = pair.between == BetweenLegs::Cylinders;
  out.at = below ? Vector3(mechanism.base_points[i] + pair.at_m * along) : Vector3(joint - pair.at_m * along);
  out.by_pose = below ? turns : PointByPose(joint_by_pose - turns);
  return out;
}

}  // namespace

LegDistance legDistance(const Mechanism& mechanism, const Pose& pose, const LegPair& pair) noexcept {
  const Matrix3 rotation = platformRotation(pose);
  const PointOfLeg a = pointOf(mechanism, pose, rotation, pair.first, pair),
                   b = pointOf(mechanism, pose, rotation, pair.second, pair);
  LegDistance out;
  if (pair.between == BetweenLegs::Lengths) {
    out.length_m = a.length_m - b.length_m;
    out.by_pose = a.length_by_pose - b.length_by_pose;
    return out;
  }
  const Vector3 span = a.at - b.at;
  out.length_m = span.norm();
  if (out.length_m > kNoDistance_m) out.by_pose = (a.by_pose - b.by_pose).transpose() * (span / out.length_m);
  return out;
}

}  // namespace knee_robot::mechanism
