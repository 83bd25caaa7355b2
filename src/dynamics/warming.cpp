#include "knee_robot/dynamics/warming.h"

#include <cmath>

namespace knee_robot::dynamics {
namespace {

constexpr double kRests_m_per_s = 1e-3;       ///< below it an axis stands rather than moves
constexpr double kWorksFully_m_per_s = 2e-2;  ///< by definition: the size of the change is per this speed

}  // namespace

std::optional<Heat> heatOf(double number) noexcept {
  for (const Heat by : {Heat::Clock, Heat::Motion, Heat::Work}) {
    if (number == numberOf(by)) return by;
  }
  return {};
}

double numberOf(Heat by) noexcept {
  return static_cast<double>(by);
}

double heatAt(Heat by, double velocity_m_per_s) noexcept {
  if (by == Heat::Clock) return 1.0;
  if (by == Heat::Work) return std::abs(velocity_m_per_s) / kWorksFully_m_per_s;
  const double square = velocity_m_per_s * velocity_m_per_s;
  return square / (square + kRests_m_per_s * kRests_m_per_s);
}

double Warmth::step(double heat, double duration_s, double time_constant_s) noexcept {
  value += (heat - value) * -std::expm1(-duration_s / time_constant_s);
  return value;
}

}  // namespace knee_robot::dynamics
