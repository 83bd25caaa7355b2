#pragma once

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {

/// The platform's pose by forward kinematics, from one cycle to the next: on the branch of the last pose, or, where none
/// is known, of the one in which the robot was built. Real-time safe.
class PoseFollower {
 public:
  /// False: there is no such pose. The last one is then kept, but the next search begins at home again.
  bool step(const Mechanism& mechanism, const Lengths& lengths) noexcept;
  /// The next search begins at home.
  void forget() noexcept { known_ = false; }

  /// The pose found last; zero before there was one.
  const Pose& pose() const noexcept { return pose_; }

 private:
  Pose pose_ = Pose::Zero();
  bool known_ = false;
};

}  // namespace knee_robot::mechanism
