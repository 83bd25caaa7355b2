#include "brake_test.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kRise_s = 0.02, kPush_s = 0.05;  // of one push; each axis gets two

}  // namespace

BrakeTest::BrakeTest(const HardwareFile& hardware) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    has_brake_[i] = hardware.axes[i].hold_device == HoldDevice::Brake;
}

bool BrakeTest::coversAllAxes() const noexcept {
  return std::all_of(has_brake_.begin(), has_brake_.end(), [](bool has) { return has; });
}

BrakeTest::Step BrakeTest::step(double time_s, const AxisValues& position_m, double force_N,
                                double slip_m) const noexcept {
  Step now;
  const int push = static_cast<int>(time_s / kPush_s);
  const auto axis = static_cast<std::size_t>(push / 2);
  now.done = force_N <= 0.0 || axis >= hardware::kAxes;
  if (now.done) return now;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const bool holds = std::abs(position_m[i] - stands_m_[i]) <= slip_m;
    if (holds || !has_brake_[i]) continue;
    now.slipped = static_cast<int>(i) + 1;
    return now;
  }
  if (!has_brake_[axis]) return now;
  const double rise = std::min(1.0, (time_s - push * kPush_s) / kRise_s);
  now.force_N[axis] = (push % 2 == 0 ? -rise : rise) * force_N;
  return now;
}

}  // namespace knee_robot::control
