#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "knee_robot/hardware/axis_bus.h"

namespace knee_robot::control {

/// Whose turn it is to be asked on a robot that stands. Where the encoders' common supply is lost nothing counts any
/// more, so that nothing looks like a disturbance (RestWatch), and whoever pushes takes the platform along. So when no
/// axis has counted for a period, one of them is asked, another one each time; if any axis has counted, the supply is
/// present and no test is needed. Pure, one for the robot, real-time safe.
class RestTurn {
 public:
  static constexpr std::int64_t kCounts = 3;  ///< range that an axis has to go through: an open input dithers by less

  using Counts = std::array<std::int64_t, hardware::kAxes>;

  /// One cycle of `dt`. `rests`: all references stand and the loops alone carry. The axis to ask now, or -1. `period_s`
  /// of 0: never.
  int step(bool rests, double dt, const Counts& counts, double period_s) noexcept {
    bool counted = !rests || period_s <= 0.0;
    for (std::size_t i = 0; i < counts.size() && !counted; ++i) {
      lowest_[i] = std::min(lowest_[i], counts[i]);
      highest_[i] = std::max(highest_[i], counts[i]);
      counted = highest_[i] - lowest_[i] >= kCounts;
    }
    stood_s_ += dt;
    const bool due = !counted && stood_s_ >= period_s;
    if (counted || due) {
      stood_s_ = 0.0;
      lowest_ = highest_ = counts;
    }
    if (!due) return -1;
    turn_ = (turn_ + 1) % hardware::kAxes;
    return static_cast<int>(turn_);
  }

 private:
  double stood_s_ = 0.0;
  Counts lowest_{}, highest_{};
  std::size_t turn_ = hardware::kAxes - 1;
};

}  // namespace knee_robot::control
