#pragma once

#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// The force has been at its clamp for time_s: the loop is not in control any more.
class SaturationMonitor {
 public:
  bool step(const AxisView& axis, double time_s) noexcept {
    return clamped_.step(!(std::abs(axis.force_N) < 0.995 * axis.force_limit_N), axis.dt, time_s);
  }
  void reset() noexcept { clamped_.reset(); }

 private:
  TrueFor clamped_;
};

}  // namespace knee_robot::control
