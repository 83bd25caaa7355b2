#pragma once

#include "knee_robot/control/hardware_file.h"
#include "knee_robot/mechanism/robot.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// With the drives off the holding brakes keep every axis where it is; an axis that moves all the same sinks, or
/// somebody moves it. Axes without a brake are left out. Real-time safe.
class HeldPlace {
 public:
  HeldPlace(const mechanism::Robot& robot, const HardwareFile& hardware) noexcept;

  /// One cycle. Looked at from the slowest brake's delay after `held` (drives off, brakes ordered to engage) on. The
  /// first axis (1 to 4) that is more than a millimetre from where it stood then, or when this was said last; 0: none.
  int step(bool held, const SupervisorView& view, rt::Nanoseconds now) noexcept;

 private:
  rt::Nanoseconds until_held_ = 0;
  rt::Nanoseconds held_since_ = 0;
  std::array<double, hardware::kAxes> metres_per_count_{};  // 0: not watched
  std::array<std::int64_t, hardware::kAxes> stood_{};       // counts: the lengths are shifted when home is confirmed
  bool held_ = false;
};

}  // namespace knee_robot::control
