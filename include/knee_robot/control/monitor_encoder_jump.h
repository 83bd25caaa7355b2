#pragma once

#include <cmath>

#include "knee_robot/control/monitor_view.h"

namespace knee_robot::control {

/// A counter that changes by more than the axis can move: interference, a loose cable, a lost index. Broken when
/// |moved| > factor * velocity_max * dt + floor. The loop must not see such a position: no command follows it.
class EncoderJumpMonitor {
 public:
  bool step(const AxisView& axis, double velocity_max, double factor, double floor_m) noexcept {
    return !(std::abs(axis.moved_m) <= factor * velocity_max * axis.dt + floor_m);
  }
};

}  // namespace knee_robot::control
