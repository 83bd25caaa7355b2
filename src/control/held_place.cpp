#include "held_place.h"

#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kMoved_m = 0.001;  // twice what an axis may give way when the brakes take over its load (slip_m)
constexpr rt::Nanoseconds kReading = 20'000'000;  // older counts are of before the brakes held

}  // namespace

HeldPlace::HeldPlace(const mechanism::Robot& robot, const HardwareFile& hardware) noexcept
    : until_held_(rt::fromSeconds(hardware.holdDelay()) + kReading) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (hardware.axes[i].hold_device == HoldDevice::Brake) metres_per_count_[i] = robot.actuators[i].metresPerCount();
  }
}

int HeldPlace::step(bool held, const SupervisorView& view, rt::Nanoseconds now) noexcept {
  if (held && view.unreadable != 0) return 0;
  if (!held || !held_) held_since_ = now;
  held_ = held;
  if (!held || now - held_since_ <= until_held_) {
    stood_ = view.measured.counts;
    return 0;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const auto moved = static_cast<double>(view.measured.counts[i] - stood_[i]);
    if (std::abs(moved * metres_per_count_[i]) <= kMoved_m) continue;
    stood_ = view.measured.counts;
    return static_cast<int>(i) + 1;
  }
  return 0;
}

}  // namespace knee_robot::control
