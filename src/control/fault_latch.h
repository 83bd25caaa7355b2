#pragma once

#include <cstdint>

#include "knee_robot/control/faults.h"

namespace knee_robot::control {

/// A fault and where it is.
struct FaultCause {
  Fault fault = Fault::None;
  int axis = 0;            ///< 1 to 4, 0: none in particular
  int component = -1;      ///< index in ComponentWatch, -1: none in particular
  std::uint16_t code = 0;  ///< emergency code of the axis' drive, 0: none
  double paused_s = 0.0;   ///< for which the servo cycle stood still shortly before; 0: it did not
  bool acute = false;      ///< somebody has to act on it now, whatever was wrong first
};

/// Keeps the first fault with its place, whatever follows, until it is cleared; only an acute one, and a holding brake
/// that does not hold, while the drives carry on or with the drives off, take the place of another. Pure, real-time safe.
class FaultLatch {
 public:
  /// True when this is the first one, or takes the first one's place. Fault::None never does.
  bool latch(const FaultCause& cause) noexcept;
  void clear() noexcept { cause_ = FaultCause{}; }
  bool isLatched() const noexcept { return cause_.fault != Fault::None; }
  const FaultCause& cause() const noexcept { return cause_; }

 private:
  FaultCause cause_;
};

}  // namespace knee_robot::control
