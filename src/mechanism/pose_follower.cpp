#include "knee_robot/mechanism/pose_follower.h"

namespace knee_robot::mechanism {

bool PoseFollower::step(const Mechanism& mechanism, const Lengths& lengths) noexcept {
  const ForwardResult found =
      known_ ? forwardKinematics(mechanism, lengths, pose_) : forwardKinematicsFromHome(mechanism, lengths);
  known_ = found.ok();
  if (known_) pose_ = found.pose;
  return known_;
}

}  // namespace knee_robot::mechanism
