#pragma once

#include <algorithm>
#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// A counter that gains speed faster than any force accelerates the axis: interference on an axis at rest, whose leaps
/// are shorter than EncoderJumpMonitor, made for the fastest motion, lets through. The loop follows each of them, and
/// none is seen later. Broken when |moved| > factor * (fastest of the last kRecent_s) * dt + acceleration * dt^2 + two
/// counts. Of a gap in which nobody could read, and of pauses, EncoderJumpMonitor judges: this grows with dt^2.
class EncoderLeapMonitor {
 public:
  static constexpr double kRecent_s = 0.1;  ///< twice; longer than any turning point of a fast motion

  bool step(const AxisView& axis, double metres_per_count, double factor, double acceleration) noexcept {
    const double way_m = std::abs(axis.moved_m);
    const double fastest = std::max(now_, before_);
    const double limit_m = factor * fastest * axis.dt + acceleration * axis.dt * axis.dt + kCounts * metres_per_count;
    since_s_ += axis.dt;
    if (since_s_ >= kRecent_s) {
      before_ = now_;
      now_ = since_s_ = 0.0;
    }
    if (axis.dt > 0.0) now_ = std::max(now_, way_m / axis.dt);
    return !axis.after_gap && axis.dt > 0.0 && !(way_m <= limit_m);
  }

 private:
  static constexpr double kCounts = 2.0;
  double now_ = 0.0, before_ = 0.0;  // fastest, m/s
  double since_s_ = 0.0;
};

}  // namespace knee_robot::control
