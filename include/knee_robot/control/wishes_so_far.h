#pragma once

#include <cstdint>

#include "knee_robot/rt/cycle.h"

namespace knee_robot::control {

/// How often somebody has wanted the robot to stand, or to move at another speed, until now. A request that was asked
/// for before and has waited meanwhile is older.
struct WishesSoFar {
  std::uint64_t halts = 0;   ///< stop(), disable(), emergencyStop(), and another one on the robot
  std::uint64_t pauses = 0;  ///< pause()
  std::uint64_t speeds = 0;  ///< setSpeed()
  rt::Nanoseconds last = 0;  ///< rt::monotonicNow() of the last halt or pause; 0: there was none
  std::uint64_t loaded = 0;  ///< PlayableReference::number() of the loaded reference; 0: there is none
};

}  // namespace knee_robot::control
