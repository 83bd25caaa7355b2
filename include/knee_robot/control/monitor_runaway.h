#pragma once

#include <algorithm>
#include <cmath>

#include "knee_robot/control/monitor_view.h"

namespace knee_robot::control {

/// The axis moves away from its reference, faster and faster, while the force pushes towards it more than it did at
/// rest: a wrong sign of encoder, drive or wiring (the loop then drives itself away), a drive that gives no force
/// although it is enabled (the load takes the axis along), or something outside that is stronger than the drive. Broken
/// when, for time_s, the error is above error_m, the axis itself moves away from the reference faster than `speed`,
/// seen from the base and from the moving reference, and it has not become slower. An axis that only lags behind a fast
/// reference moves towards it, one that runs a little ahead of it keeps its distance, one that overshoots becomes
/// slower, and so does one that somebody pushes against a healthy loop.
class RunawayMonitor {
 public:
  bool step(const AxisView& axis, double error_m, double speed, double time_s) noexcept {
    const double error = axis.reference_m - axis.position_m;
    const double side = error > 0.0 ? -1.0 : 1.0;
    const double away = std::min(side * axis.velocity, side * (axis.velocity - axis.reference_velocity));  // m/s
    const bool pushed_back = error > 0.0 ? axis.force_N > last_force_N_ : axis.force_N < last_force_N_;
    const bool clamped = std::abs(axis.force_N) >= 0.999 * axis.force_limit_N;
    const bool runs = std::abs(error) > error_m && away > speed && away >= last_away_ && (pushed_back || clamped);
    last_away_ = away;
    last_force_N_ = axis.force_N;
    return running_.step(runs, axis.dt, time_s);
  }
  /// The axis is running away now, though not long enough to be sure.
  bool suspects() const noexcept { return running_.isTrue(); }
  void reset() noexcept {
    running_.reset();
    last_away_ = 0.0;
    last_force_N_ = 0.0;
  }

 private:
  TrueFor running_;
  double last_away_ = 0.0;
  double last_force_N_ = 0.0;
};

}  // namespace knee_robot::control
