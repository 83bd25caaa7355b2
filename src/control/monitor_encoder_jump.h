#pragma once

#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// A counter that changes by more than the axis can move: interference, a loose cable, a lost index. Broken when
/// |moved| > factor * velocity_max * dt + floor. The loop must not see such a position: no command follows it. After a
/// gap in which nobody could read, not more than `gap_m` however long it was: the brakes hold then, and who has lost
/// its counts begins anew.
class EncoderJumpMonitor {
 public:
  bool step(const AxisView& axis, double velocity_max, double factor, double floor_m, double gap_m) noexcept {
    const double limit = factor * velocity_max * axis.dt + floor_m;
    return !(std::abs(axis.moved_m) <= (axis.after_gap ? std::min(limit, gap_m) : limit));
  }
};

}  // namespace knee_robot::control
