#pragma once

#include <optional>

namespace knee_robot::dynamics {

/// What warms a drive up; the number that model files write (`heated_by`).
enum class Heat {
  Clock = 0,    ///< time alone, from the moment the drive takes up load
  Motion = 1,   ///< the time in motion; it cools at rest
  Work = 2,     ///< the power of friction; it cools at rest
  Worked = 3,   ///< the work of friction so far, each joule less than the one before (grease that is worked, friction
                ///< that falls off exponentially with what it has warmed); it does not cool
  Winding = 4,  ///< the power that a motor's windings lose: the square of the force that it gives
};

struct HeatSource {
  Heat by = Heat::Clock;
  double viscous_s_per_m = 0.0;  ///< viscous friction per dry friction: its part in the power
  double levels_off = 0.0;       ///< 0: what warmth changes is in proportion to it; else see felt
};

/// What a warmth changes, in units of what little warmth would: w / (1 + levels_off w). A lubricant's viscosity falls
/// less and less as it warms up.
double felt(const HeatSource& by, double warmth) noexcept;

/// The heat that a number stands for; none: the number stands for nothing.
std::optional<Heat> heatOf(double number) noexcept;
double numberOf(Heat by) noexcept;

/// How warm a drive is, 0 cold, 1 warmed up by a heat of 1: a first-order lag of that heat. The heat, by the clock: 1. In
/// motion: 1, beyond about 1 mm/s. By work: the power over that of dry friction at 20 mm/s. By what was worked: 1, but
/// time passes in proportion to that power. By the windings: whatever share of a usual power they lose (`warm`).
/// Real-time safe.
struct Warmth {
  double value = 0.0;

  /// A time (s) under one heat.
  double warm(double heat, double duration_s, double time_constant_s) noexcept;

  /// A time (s) at one speed. Both return the new value.
  double move(const HeatSource& by, double velocity_m_per_s, double duration_s, double time_constant_s) noexcept;
  /// A time without power.
  double cool(Heat by, double duration_s, double time_constant_s) noexcept;
};

}  // namespace knee_robot::dynamics
