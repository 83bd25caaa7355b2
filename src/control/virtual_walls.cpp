#include "virtual_walls.h"

#include <algorithm>

#include "knee_robot/trajectory/pose_limits.h"

namespace knee_robot::control {

/// A hand that pushes a little is a large force on a leg near a singularity: a margin that is wide open does not hold
/// here.
VirtualWalls::VirtualWalls(const mechanism::Robot& robot)
    : mechanism_(robot.mechanism), joints_(robot.joints), condition_max_(trajectory::planningCondition(robot)) {
  for (Eigen::Index i = 0; i < mechanism::kLegs && i < robot.axes(); ++i) {
    shortest_[i] = robot.actuators[static_cast<std::size_t>(i)].position_min_m;
    longest_[i] = robot.actuators[static_cast<std::size_t>(i)].position_max_m;
  }
}

double VirtualWalls::freedom(const mechanism::Pose& pose) const noexcept {
  const mechanism::JointAngles angles = mechanism::jointAngles(*mechanism_, pose);
  double left = (1.0 - mechanism::conditionNumber(*mechanism_, pose) / condition_max_) / kCondition;
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    const double base_max = i == 3 ? joints_.revolute_max : joints_.universal_max;
    left = std::min(left, (base_max - angles.base[i]) / kAngle_rad);
    if (i < 3) left = std::min(left, (joints_.spherical_max - angles.platform[i]) / kAngle_rad);
  }
  return left;
}

void VirtualWalls::addPose(const mechanism::Pose& pose, const PatientRange& patient, double largest_N,
                           Push& push) const noexcept {
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double zone = std::min(i < 2 ? kPose_m : kPose_rad, 0.25 * (patient.maximum[k] - patient.minimum[k]));
    const double below = (patient.minimum[k] + zone - pose[i]) / zone,
                 above = (pose[i] - patient.maximum[k] + zone) / zone;
    const double depth = std::max({0.0, below, above});
    push.wrench[i] += (below > above ? 1.0 : -1.0) * std::min(1.0, depth) * largest_N * (i < 2 ? 1.0 : kLever_m);
    push.depth = std::max(push.depth, depth);
  }
}

/// Along the gradient of what is left, lengths and angles made comparable by the lever.
void VirtualWalls::addJoints(const mechanism::Pose& pose, double largest_N, Push& push) const noexcept {
  constexpr double kStep_m = 1e-4;
  const double left = freedom(pose);
  if (left >= 1.0) return;
  mechanism::Vector4 slope;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const mechanism::Pose step = (i < 2 ? kStep_m : kStep_m / kLever_m) * mechanism::Pose::Unit(i);
    slope[i] = (freedom(pose + step) - freedom(pose - step)) / (2.0 * kStep_m);
  }
  const double steepness = slope.norm();
  const double depth = 1.0 - left;
  push.depth = std::max(push.depth, depth);
  if (!(steepness > 0.0)) return;
  const mechanism::Vector4 way = std::min(1.0, depth) * largest_N / steepness * slope;
  push.wrench += mechanism::Vector4(way[0], way[1], kLever_m * way[2], kLever_m * way[3]);
}

VirtualWalls::Push VirtualWalls::at(const mechanism::Pose& pose, const mechanism::Lengths& lengths,
                                    const PatientRange& patient, double largest_N) const noexcept {
  Push push;
  for (Eigen::Index i = 0; i < mechanism::kLegs; ++i) {
    const double shorter = (shortest_[i] + kLength_m - lengths[i]) / kLength_m;
    const double longer = (lengths[i] - longest_[i] + kLength_m) / kLength_m;
    const double depth = std::max({0.0, shorter, longer});
    push.force[i] = (shorter > longer ? 1.0 : -1.0) * std::min(1.0, depth) * largest_N;
    push.depth = std::max(push.depth, depth);
  }
  if (!mechanism_) return push;
  addJoints(pose, largest_N, push);
  if (patient.given) addPose(pose, patient, largest_N, push);
  return push;
}

}  // namespace knee_robot::control
