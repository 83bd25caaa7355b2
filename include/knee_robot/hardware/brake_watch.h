#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/channels.h"

namespace knee_robot::hardware {

/// What tells a guardian that a holding brake does not hold.
struct BrakeWatch {
  std::array<std::int32_t, kChannels> slip_counts{};  ///< so far an axis moves whose brake slips; 0: nothing is watched
  std::array<double, kChannels> counts_per_mm{};      ///< of the encoders
};

}  // namespace knee_robot::hardware
