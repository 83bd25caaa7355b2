#pragma once

#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// The drive pushes and the axis stands: |force| >= share * limit and |velocity| < speed for time_s, away from where it
/// should be.
class StallMonitor {
 public:
  bool step(const AxisView& axis, double share, double speed, double error_m, double time_s) noexcept {
    const bool pushes = !(std::abs(axis.force_N) < share * axis.force_limit_N);
    const bool stands = std::abs(axis.velocity) < speed;
    const bool away = std::abs(axis.reference_m - axis.position_m) > error_m;
    return stalled_.step(pushes && stands && away, axis.dt, time_s);
  }
  void reset() noexcept { stalled_.reset(); }
  /// How long it has seemed so.
  double time_s() const noexcept { return stalled_.time_s(); }

 private:
  TrueFor stalled_;
};

}  // namespace knee_robot::control
