#include "knee_robot/control/held_place.h"

#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kMoved_m = 0.001;  // twice what an axis may give way when the brakes take over its load (slip_m)

}  // namespace

HeldPlace::HeldPlace(const mechanism::Robot& robot, const HardwareFile& hardware) noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (hardware.axes[i].hold_device == HoldDevice::Brake) metres_per_count_[i] = robot.actuators[i].metresPerCount();
  }
}

int HeldPlace::step(bool held, const SupervisorView& view) noexcept {
  if (held && view.unreadable != 0) return 0;
  if (!held || !held_) stood_ = view.measured.counts;
  held_ = held;
  for (std::size_t i = 0; held && i < hardware::kAxes; ++i) {
    const auto moved = static_cast<double>(view.measured.counts[i] - stood_[i]);
    if (std::abs(moved * metres_per_count_[i]) > kMoved_m) return static_cast<int>(i) + 1;
  }
  return 0;
}

}  // namespace knee_robot::control
