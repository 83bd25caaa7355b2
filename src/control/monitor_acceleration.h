#pragma once

#include <array>
#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// Change of the low-passed velocity over kWindow cycles, against `limit` (m/s^2): over a single cycle, one count of an
/// encoder alone would be several m/s^2.
class AccelerationMonitor {
 public:
  static constexpr int kWindow = 20;

  bool step(const AxisView& axis, double limit) noexcept {
    const double oldest_velocity = velocities_[next_];
    const double oldest_time = times_[next_];
    time_ += axis.dt;
    velocities_[next_] = axis.velocity;
    times_[next_] = time_;
    next_ = (next_ + 1) % kWindow;
    if (filled_ < kWindow) {
      ++filled_;
      return false;
    }
    return !(std::abs(axis.velocity - oldest_velocity) <= limit * (time_ - oldest_time));
  }
  void reset() noexcept { filled_ = 0; }

 private:
  std::array<double, kWindow> velocities_{};
  std::array<double, kWindow> times_{};
  std::size_t next_ = 0;
  int filled_ = 0;
  double time_ = 0.0;
};

}  // namespace knee_robot::control
