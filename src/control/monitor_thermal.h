#pragma once

#include "monitor_view.h"

namespace knee_robot::control {

/// I2t with two time constants: the winding above its housing (seconds) and the housing above the room (a quarter of an
/// hour), each a first-order lag of (force / continuous force)^2; `winding_share` of the final rise is the winding's. 0
/// is cold, 1 what the continuous force leads to in the end; above 1 is the fault. Goes on through every state, and is
/// not forgotten by a reset; a controller that is started anew begins at `start` (HeatMemory knows what was before).
class ThermalMonitor {
 public:
  bool step(const AxisView& axis, double force_continuous_N, double winding_s, double winding_share = 1.0,
            double housing_s = 1.0) noexcept {
    if (force_continuous_N <= 0.0) return false;
    const double load = axis.force_N / force_continuous_N;
    winding_ += (load * load - winding_) * axis.dt / (winding_s + axis.dt);
    housing_ += (load * load - housing_) * axis.dt / (housing_s + axis.dt);
    heat_ = winding_share * winding_ + (1.0 - winding_share) * housing_;
    return !(heat_ <= 1.0);
  }
  void start(double heat) noexcept { heat_ = winding_ = housing_ = heat; }
  double heat() const noexcept { return heat_; }

 private:
  double heat_ = 0.0, winding_ = 0.0, housing_ = 0.0;
};

}  // namespace knee_robot::control
