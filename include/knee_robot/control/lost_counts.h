#pragma once

#include "knee_robot/control/supervisor_view.h"

namespace knee_robot::control {

/// Which axes do not know where they are any more: they may have moved while their encoders did not count. Counters go
/// on from where they stood when the cable is put back, and nothing of that is seen later.
///
/// - encoder_jump: that axis, at once.
/// - encoder_frozen: all axes, as the encoders may have lost their common supply and only one was asked.
/// - axis_blocked: all axes, unless another axis has just counted. Then the supply is there, and what was asked is
///   known to stand still.
///
/// The last two count when the drives are off: until then the feedforward needs a place, and this one is not far off.
///
/// Real-time safe.
class LostCounts {
 public:
  using Axes = std::array<bool, hardware::kAxes>;

  /// One cycle. True: the axis has to be homed again.
  Axes step(const SupervisorView& view, rt::Nanoseconds now) noexcept;

 private:
  bool othersCount(const SupervisorView& view, std::size_t axis) const noexcept;

  Axes doubted_{}, blocked_{};
  std::array<std::int64_t, hardware::kAxes> mark_{}, mark_before_{};
  rt::Nanoseconds marked_at_ = 0;
};

}  // namespace knee_robot::control
