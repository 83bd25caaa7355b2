#pragma once

#include <algorithm>
#include <cmath>

namespace knee_robot::dynamics {

/// Where a screw whirls: around a critical speed, which falls with the square of its free length (a slender beam's first
/// mode).
struct Whirl {
  double critical_m_per_s = 0.0;  ///< of the actuator, at `at_length_m`
  double width_m_per_s = 0.0;     ///< half of the peak's width at half of its height
  double at_length_m = 1.0;

  /// Share of the drag at the peak, with the velocity's sign: 1 / (1 + ((|v| - v_c) / width)^2).
  double share(double length_m, double velocity_m_per_s) const noexcept {
    constexpr double kRests_m_per_s = 1e-3;  // smooth below it: where it whirls it is faster
    const double shorter = at_length_m / std::max(length_m, 0.1 * at_length_m);
    const double beside = (std::abs(velocity_m_per_s) - critical_m_per_s * shorter * shorter) / width_m_per_s;
    return velocity_m_per_s / std::hypot(velocity_m_per_s, kRests_m_per_s) / (1.0 + beside * beside);
  }
};

}  // namespace knee_robot::dynamics
