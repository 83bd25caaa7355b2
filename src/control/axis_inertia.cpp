#include "knee_robot/control/axis_inertia.h"

#include <Eigen/Dense>
#include <limits>

#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/trajectory/pose_limits.h"

namespace knee_robot::control {
namespace {

/// Grid over the box of poses that any robot of this kind can take: m, m, rad, rad.
constexpr double kLow[4] = {-0.5, 0.3, -0.8, -0.5}, kHigh[4] = {0.5, 1.1, 0.8, 0.5};
constexpr int kSteps[4] = {9, 9, 7, 5};

dynamics::RobotInertia withPayload(dynamics::RobotInertia inertia, double payload_kg) {
  dynamics::LinkInertia& platform = inertia.links.back();
  const double mass = platform.mass + payload_kg;
  if (payload_kg <= 0.0) return inertia;
  // Steiner: about the new centre, on the way from the platform's to its origin.
  const mechanism::Vector3 center = platform.center * (platform.mass / mass);
  const auto about = [](double m, const mechanism::Vector3& d) -> mechanism::Matrix3 {
    return m * (d.squaredNorm() * mechanism::Matrix3::Identity() - d * d.transpose());
  };
  platform.inertia += about(platform.mass, platform.center - center) + about(payload_kg, center);
  platform.center = center;
  platform.mass = mass;
  return inertia;
}

AxisInertia inertiaAt(const dynamics::RigidModel& model, const mechanism::Pose& pose) {
  mechanism::Motion motion;
  motion.pose = pose;
  mechanism::Vector4 at_rest, forces;
  mechanism::Matrix4 per_pose = mechanism::Matrix4::Zero();
  bool regular = dynamics::inverseDynamics(model, motion, at_rest);
  for (int k = 0; k < 4 && regular; ++k) {
    motion.pose_acceleration = mechanism::Vector4::Unit(k);
    regular = dynamics::inverseDynamics(model, motion, forces);
    if (regular) per_pose.col(k) = forces - at_rest;
  }
  const mechanism::Matrix4 jacobian = mechanism::lengthJacobian(model.mechanism, pose);
  AxisInertia inertia{mechanism::Matrix4::Constant(std::numeric_limits<double>::quiet_NaN())};
  if (regular) inertia.matrix = per_pose * jacobian.inverse();
  return inertia;
}

}  // namespace

mechanism::Vector4 AxisInertia::free() const {
  return matrix.inverse().diagonal().cwiseInverse();
}

AxisInertia axisInertia(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia,
                        const mechanism::Pose& pose, double payload_kg) {
  return inertiaAt({*robot.mechanism, robot.gravity, withPayload(inertia, payload_kg)}, pose);
}

AxisInertiaRange axisInertiaRange(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia,
                                  double payload_kg, const std::vector<mechanism::Pose>& poses) {
  const dynamics::RigidModel model(*robot.mechanism, robot.gravity, withPayload(inertia, payload_kg));
  AxisInertiaRange range{mechanism::Vector4::Constant(std::numeric_limits<double>::infinity()),
                         mechanism::Vector4::Zero(), 0};
  for (const mechanism::Pose& pose : poses) {
    const AxisInertia one = inertiaAt(model, pose);
    if (!one.matrix.allFinite()) continue;
    range.low = range.low.cwiseMin(one.free());
    range.high = range.high.cwiseMax(one.locked());
    ++range.poses;
  }
  return range;
}

std::vector<mechanism::Pose> posesWithin(const mechanism::Robot& robot, double condition_max) {
  std::vector<mechanism::Pose> poses;
  const double condition = trajectory::planningCondition(robot);
  const int total = kSteps[0] * kSteps[1] * kSteps[2] * kSteps[3];
  for (int k = 0; k < total; ++k) {
    mechanism::Pose pose;
    for (int c = 0, rest = k; c < 4; rest /= kSteps[c], ++c)
      pose[c] = kLow[c] + (kHigh[c] - kLow[c]) * (rest % kSteps[c]) / (kSteps[c] - 1);
    if (trajectory::nearestLimit(robot, pose, condition).left >= 0.0 &&
        mechanism::conditionNumber(*robot.mechanism, pose) <= condition_max)
      poses.push_back(pose);
  }
  return poses;
}

}  // namespace knee_robot::control
