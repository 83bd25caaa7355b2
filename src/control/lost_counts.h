#pragma once

#include "supervisor_view.h"

namespace knee_robot::control {

/// Which axes do not know where they are any more: they may have moved while their encoders did not count. Counters go
/// on from where they stood when the cable is put back, and nothing of that is seen later.
///
/// - encoder_jump: that axis, at once.
/// - encoder_frozen: all axes, as the encoders may have lost their common supply and only one was asked.
/// - axis_blocked: all axes, unless another axis has just counted: then the supply is there, and it is that axis only.
///   That the others felt nothing of its pulses is likely to be so, not certain.
/// - any fault: an axis that has not counted while its reference went on by kUnseen_m. Blind, it shakes the platform
///   until another axis' fault comes first.
///
/// The last three count when the drives are off: until then the feedforward needs a place, and this one is not far off.
///
/// Real-time safe.
class LostCounts {
 public:
  using Axes = std::array<bool, hardware::kAxes>;

  /// Ten times the following error of a good loop, and more than sticking at a turning point takes.
  static constexpr double kUnseen_m = 5e-4;

  /// One cycle; `faulted`: a fault is latched. True: the axis has to be homed again.
  Axes step(const SupervisorView& view, bool faulted, rt::Nanoseconds now) noexcept;

 private:
  void watch(const SupervisorView& view, std::size_t axis) noexcept;
  bool othersCount(const SupervisorView& view, std::size_t axis) const noexcept;

  Axes doubted_{}, blocked_{}, unseen_{};
  std::array<std::int64_t, hardware::kAxes> seen_counts_{};  // when each axis counted last, and its reference then
  AxisValues seen_reference_m_{};
  std::array<std::int64_t, hardware::kAxes> mark_{}, mark_before_{};
  rt::Nanoseconds marked_at_ = 0;
};

}  // namespace knee_robot::control
