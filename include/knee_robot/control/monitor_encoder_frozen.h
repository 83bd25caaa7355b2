#pragma once

#include <cmath>

#include "knee_robot/control/monitor_view.h"

namespace knee_robot {

/// An encoder that does not count while its reference moves on, or only dithers as an open input does. Judged when the reference has
/// moved by `distance_m` and the force has changed by `force_N`, which must be more than sticking friction takes: broken when the
/// encoder has moved less than a tenth of the reference. One axis alone cannot tell a dead encoder from an axis that is blocked: the
/// fault names both. It comes before the following-error limit, because a dead encoder lets its axis run with a growing force.
class EncoderFrozenMonitor {
 public:
  bool step(const AxisView& axis, double distance_m, double force_N) noexcept {
    if (!known_) begin(axis);
    moved_m_ += axis.moved_m;
    const double wanted = std::abs(axis.reference_m - from_m_);
    if (wanted < distance_m) return false;
    const bool follows = std::abs(moved_m_) >= 0.1 * wanted;
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
    moved_m_ = 0.0;
  }
  bool known_ = false;
  double from_m_ = 0.0, from_N_ = 0.0, moved_m_ = 0.0;
};

}  // namespace knee_robot
