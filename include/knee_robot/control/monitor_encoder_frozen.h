#pragma once

#include <cmath>

#include "knee_robot/control/monitor_view.h"

namespace knee_robot {

/// An encoder that does not count while its reference moves on, or only dithers as an open input does. Judged whenever the reference
/// has moved by `distance_m`: broken when the encoder has moved less than a tenth of that. One axis alone cannot tell a dead encoder
/// from an axis that is blocked: the fault names both. It comes long before the following-error limit, because a dead encoder lets
/// its axis run with a growing force.
class EncoderFrozenMonitor {
 public:
  bool step(const AxisView& axis, double distance_m) noexcept {
    if (!known_) begin(axis.reference_m);
    moved_m_ += axis.moved_m;
    const double wanted = std::abs(axis.reference_m - from_m_);
    if (wanted < distance_m) return false;
    if (!(std::abs(moved_m_) >= 0.1 * wanted)) return true;
    begin(axis.reference_m);
    return false;
  }
  void reset() noexcept { known_ = false; }

 private:
  void begin(double reference_m) noexcept {
    known_ = true;
    from_m_ = reference_m;
    moved_m_ = 0.0;
  }
  bool known_ = false;
  double from_m_ = 0.0, moved_m_ = 0.0;
};

}  // namespace knee_robot
