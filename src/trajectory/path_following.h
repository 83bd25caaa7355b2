#pragma once

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::trajectory {

/// Follows the platform's pose along a path of lengths on one assembly branch: a step that fails or that moves the pose
/// suspiciously far is divided, so that a fold or a jump to another branch is noticed instead of leapt over.
class PathFollower {
 public:
  PathFollower(const mechanism::Mechanism& mechanism, const mechanism::Lengths& lengths, const mechanism::Pose& pose)
      : mechanism_(&mechanism), lengths_(lengths), pose_(pose) {}

  /// Moves to `lengths` in a straight line. False when the branch ends or a singularity is crossed on the way; then the
  /// last pose that was reached is kept.
  bool moveTo(const mechanism::Lengths& lengths);

  const mechanism::Pose& pose() const { return pose_; }

 private:
  bool moveTo(const mechanism::Lengths& lengths, int divisions_left);

  const mechanism::Mechanism* mechanism_;
  mechanism::Lengths lengths_;
  mechanism::Pose pose_;
};

}  // namespace knee_robot::trajectory
