#include "path_following.h"

#include <algorithm>

namespace knee_robot::trajectory {
namespace {

constexpr double kLargestTranslation = 0.02;  ///< m that one undivided step may move the pose
constexpr double kLargestRotation = 0.05;     ///< rad
constexpr int kMaximumDivisions = 8;          ///< halvings of one step

bool isNear(const mechanism::Pose& a, const mechanism::Pose& b) {
  const mechanism::Pose step = (a - b).cwiseAbs();
  return std::max(step[0], step[1]) <= kLargestTranslation && std::max(step[2], step[3]) <= kLargestRotation;
}

}  // namespace

bool PathFollower::moveTo(const mechanism::Lengths& lengths) {
  return moveTo(lengths, kMaximumDivisions);
}

bool PathFollower::moveTo(const mechanism::Lengths& lengths, int divisions_left) {
  const mechanism::ForwardResult next = mechanism::forwardKinematics(*mechanism_, lengths, pose_);
  if (next.ok() && isNear(next.pose, pose_)) {
    pose_ = next.pose;
    lengths_ = lengths;
    return true;
  }
  if (divisions_left == 0) return false;
  const mechanism::Lengths middle = 0.5 * (lengths_ + lengths);
  return moveTo(middle, divisions_left - 1) && moveTo(lengths, divisions_left - 1);
}

}  // namespace knee_robot::trajectory
