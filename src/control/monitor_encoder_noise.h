#pragma once

#include <algorithm>
#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// A counter that goes to and fro faster than an axis can: open inputs beside motor cables, a broken shield. Its mean
/// says nothing of the axis, and it answers every test. Broken when it has turned round kTurns times more than an axis
/// could in that time; a turn counts when it went at least `least_m` since the last one. A loop that is unstable
/// oscillates at some ten hertz, and a test pulse lasts 8 ms.
class EncoderNoiseMonitor {
 public:
  static constexpr double kPossible_per_s = 200.0;  ///< turns: an oscillation of 100 Hz
  static constexpr double kTurns = 10.0;            ///< white noise, read at 1 kHz: within some 25 ms
  static constexpr double kLeast_m = 1e-5;
  static constexpr double kCounts = 2.0;  ///< a healthy encoder dithers by one

  bool step(const AxisView& axis, double metres_per_count) noexcept {
    const double least_m = std::max(kLeast_m, kCounts * metres_per_count);
    turns_ = std::max(0.0, turns_ - kPossible_per_s * axis.dt);
    if (axis.moved_m * went_m_ < 0.0) {
      if (std::abs(went_m_) >= 0.999 * least_m) turns_ = std::min(turns_ + 1.0, kTurns);
      went_m_ = 0.0;
    }
    went_m_ += axis.moved_m;
    return turns_ >= kTurns;
  }

 private:
  double turns_ = 0.0;
  double went_m_ = 0.0;  // since it turned round last
};

}  // namespace knee_robot::control
