#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "knee_robot/hardware/axis_bus.h"
#include "rest_turn.h"

namespace knee_robot::control {

/// Whose turn it is to be asked while the axes are homed. One searches, and what the others carry changes on its way; a
/// blind one among them gives way to that, and its loop sees nothing. So each that has stood for kStood_s is asked. The
/// one that searches is asked by its loop's force (StandingAxis). Pure, one for the robot, real-time safe.
class HomingTurn {
 public:
  static constexpr double kStood_s = 0.4;   // a healthy axis sticks meanwhile, and friction holds a blind one
  static constexpr double kApart_s = 0.12;  // between two questions: longer than one takes

  /// One cycle of `dt`. `searching`: mask of the axis that looks for its home; 0: nobody is asked. The axis to ask now,
  /// or -1.
  int step(std::uint8_t searching, double dt, const RestTurn::Counts& counts) noexcept {
    since_s_ += dt;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      Axis& axis = axes_[i];
      axis.lowest = std::min(axis.lowest, counts[i]);
      axis.highest = std::max(axis.highest, counts[i]);
      axis.stood_s += dt;
      const bool holds = searching != 0 && (searching >> i & 1u) == 0;
      if (!holds || axis.highest - axis.lowest >= RestTurn::kCounts) axis = {counts[i], counts[i], 0.0};
    }
    if (since_s_ < kApart_s) return -1;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      turn_ = (turn_ + 1) % counts.size();
      if (axes_[turn_].stood_s < kStood_s) continue;
      axes_[turn_] = {counts[turn_], counts[turn_], 0.0};
      since_s_ = 0.0;
      return static_cast<int>(turn_);
    }
    return -1;
  }

 private:
  struct Axis {
    std::int64_t lowest = 0, highest = 0;
    double stood_s = 0.0;
  };
  std::array<Axis, hardware::kAxes> axes_{};
  std::size_t turn_ = hardware::kAxes - 1;
  double since_s_ = 0.0;
};

}  // namespace knee_robot::control
