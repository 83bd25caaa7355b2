#pragma once

#include <optional>

namespace knee_robot::dynamics {

/// What warms a drive up; the number that model files write (`heated_by`).
enum class Heat {
  Clock = 0,   ///< time alone, from the moment the drive takes up load
  Motion = 1,  ///< the time in motion; it cools at rest
  Work = 2,    ///< the way, and with it the work of dry friction; it cools at rest
};

/// The heat that a number stands for; none: the number stands for nothing.
std::optional<Heat> heatOf(double number) noexcept;
double numberOf(Heat by) noexcept;

/// Heat that a drive takes up at this speed (m/s), as a share of what warms it up for good. By the clock: 1. In motion:
/// 1, beyond about 1 mm/s. By work: speed / 20 mm/s. Real-time safe.
double heatAt(Heat by, double velocity_m_per_s) noexcept;

/// How warm a drive is, 0 cold, 1 warmed up by a heat of 1: a first-order lag of that heat. Real-time safe.
struct Warmth {
  double value = 0.0;

  /// A time at one heat (s); no heat: it cools.
  double step(double heat, double duration_s, double time_constant_s) noexcept;
};

}  // namespace knee_robot::dynamics
