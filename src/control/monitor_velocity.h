#pragma once

#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// |velocity| <= factor * velocity_max + floor, for longer than a few noisy counts.
class VelocityMonitor {
 public:
  bool step(const AxisView& axis, double velocity_max, double factor, double floor, double time_s) noexcept {
    return above_.step(!(std::abs(axis.velocity) <= factor * velocity_max + floor), axis.dt, time_s);
  }
  void reset() noexcept { above_.reset(); }

 private:
  TrueFor above_;
};

}  // namespace knee_robot::control
