#include "knee_robot/dynamics/warming.h"

#include <cmath>

namespace knee_robot::dynamics {
namespace {

constexpr double kRests_m_per_s = 1e-3;       ///< below it an axis stands rather than moves
constexpr double kWorksFully_m_per_s = 2e-2;  ///< by definition: the size of the change is per this speed

/// Power of friction over that of dry friction at the speed above.
double powerAt(const HeatSource& source, double velocity_m_per_s) noexcept {
  const double speed = std::abs(velocity_m_per_s);
  return speed * (1.0 + source.viscous_s_per_m * speed) / kWorksFully_m_per_s;
}

/// As a share of what warms it up for good.
double heatAt(const HeatSource& source, double velocity_m_per_s) noexcept {
  if (source.by == Heat::Clock || source.by == Heat::Worked) return 1.0;
  if (source.by == Heat::Work) return powerAt(source, velocity_m_per_s);
  const double square = velocity_m_per_s * velocity_m_per_s;
  return square / (square + kRests_m_per_s * kRests_m_per_s);
}

double lagged(double value, double heat, double time_constants) noexcept {
  return value + (heat - value) * -std::expm1(-time_constants);
}

}  // namespace

std::optional<Heat> heatOf(double number) noexcept {
  for (const Heat by : {Heat::Clock, Heat::Motion, Heat::Work, Heat::Worked, Heat::Winding}) {
    if (number == numberOf(by)) return by;
  }
  return {};
}

double numberOf(Heat by) noexcept {
  return static_cast<double>(by);
}

double felt(const HeatSource& by, double warmth) noexcept {
  return warmth / (1.0 + by.levels_off * warmth);
}

double Warmth::warm(double heat, double duration_s, double time_constant_s) noexcept {
  return value = lagged(value, heat, duration_s / time_constant_s);
}

double Warmth::move(const HeatSource& by, double velocity_m_per_s, double duration_s, double time_constant_s) noexcept {
  const double pace = by.by == Heat::Worked ? powerAt(by, velocity_m_per_s) : 1.0;
  return value = lagged(value, heatAt(by, velocity_m_per_s), pace * duration_s / time_constant_s);
}

double Warmth::cool(Heat by, double duration_s, double time_constant_s) noexcept {
  return value = lagged(value, 0.0, by == Heat::Worked ? 0.0 : duration_s / time_constant_s);
}

}  // namespace knee_robot::dynamics
