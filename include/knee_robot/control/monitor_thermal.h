#pragma once

#include "knee_robot/control/monitor_view.h"

namespace knee_robot::control {

/// I2t: the winding's heat as a first-order lag of (force / continuous force)^2. 0 is cold, 1 what the continuous force leads to in
/// the end; above 1 is the fault. Goes on through every state, and is not forgotten by a reset; a controller that is started anew
/// begins at `start` (HeatMemory knows what was before).
class ThermalMonitor {
 public:
  bool step(const AxisView& axis, double force_continuous_N, double time_constant_s) noexcept {
    if (force_continuous_N <= 0.0) return false;
    const double load = axis.force_N / force_continuous_N;
    heat_ += (load * load - heat_) * axis.dt / (time_constant_s + axis.dt);
    return !(heat_ <= 1.0);
  }
  void start(double heat) noexcept { heat_ = heat; }
  double heat() const noexcept { return heat_; }

 private:
  double heat_ = 0.0;
};

}  // namespace knee_robot::control
