#pragma once

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {

/// What of two legs comes nearer when something between them becomes shorter.
enum class BetweenLegs {
  Lengths,    ///< the first one's length less the second's: what runs along both, up one and down the other
  Cylinders,  ///< points of the lower parts, so far from the base joints
  Rods,       ///< points of the upper parts, so far below the platform joints
};

/// Two of the legs, 0 to 3, and how something is tied to them.
struct LegPair {
  int first = 0, second = 1;
  BetweenLegs between = BetweenLegs::Cylinders;
  double at_m = 0.2;  ///< from the joints, along the legs: as trace and its models have it; Lengths: not used
};

/// A length that a pose decides, and its gradient (m/m, m/rad): the generalized force on the pose per newton that
/// lengthens it.
struct LegDistance {
  double length_m = 0.0;
  Vector4 by_pose = Vector4::Zero();
};

/// At `pose`. Two points at one place have no direction: a gradient of zero. Real-time safe.
LegDistance legDistance(const Mechanism& mechanism, const Pose& pose, const LegPair& pair) noexcept;

}  // namespace knee_robot::mechanism
