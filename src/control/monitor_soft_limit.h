#pragma once

#include "monitor_view.h"

namespace knee_robot::control {

/// The robot file's range, while the axis moves outwards: one that stands outside may be brought back inside. (The hard
/// limit, a margin farther, is the Supervisor's position_out_of_range.)
class SoftLimitMonitor {
 public:
  bool step(const AxisView& axis, double minimum_m, double maximum_m, double margin_m, double speed) noexcept {
    const bool inside = axis.position_m >= minimum_m - margin_m && axis.position_m <= maximum_m + margin_m;
    const bool outwards = axis.position_m > maximum_m ? !(axis.velocity <= speed) : !(axis.velocity >= -speed);
    return !inside && outwards;
  }
};

}  // namespace knee_robot::control
