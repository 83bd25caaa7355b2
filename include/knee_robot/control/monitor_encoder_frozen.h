#pragma once

#include <algorithm>
#include <cmath>

#include "knee_robot/control/monitor_view.h"

namespace knee_robot::control {

/// An encoder that does not count while its reference moves on, or only dithers as an open input does. Judged when the reference has
/// moved by `distance_m` and the force has changed by `force_N`, which must be more than sticking friction takes: broken when the
/// encoder has stayed within a tenth of that all the while (within, not net: behind a turning point a healthy axis may be back where it
/// was when the reference is not). One axis alone cannot tell a dead encoder from an axis that is blocked: the
/// fault names both. It comes before the following-error limit, because a dead encoder lets its axis run with a growing force.
class EncoderFrozenMonitor {
 public:
  bool step(const AxisView& axis, double distance_m, double force_N) noexcept {
    if (!known_) begin(axis);
    moved_m_ += axis.moved_m;
    lowest_m_ = std::min(lowest_m_, moved_m_);
    highest_m_ = std::max(highest_m_, moved_m_);
    const double wanted = std::abs(axis.reference_m - from_m_);
    if (wanted < distance_m) return false;
    const bool follows = highest_m_ - lowest_m_ >= 0.1 * wanted;
    if (!follows) return !(std::abs(axis.force_N - from_N_) < force_N);
    begin(axis);
    return false;
  }
  void reset() noexcept { known_ = false; }

 private:
  void begin(const AxisView& axis) noexcept {
    known_ = true;
    from_m_ = axis.reference_m;
    from_N_ = axis.force_N;
    moved_m_ = lowest_m_ = highest_m_ = 0.0;
  }
  bool known_ = false;
  double from_m_ = 0.0, from_N_ = 0.0, moved_m_ = 0.0;
  double lowest_m_ = 0.0, highest_m_ = 0.0;  // of moved_m_
};

}  // namespace knee_robot::control
