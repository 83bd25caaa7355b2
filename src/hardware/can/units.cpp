#include "knee_robot/hardware/can/units.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::hardware::can {

std::int16_t toPerMille(double volts, const AxisUnits& units, int limit_per_mille) noexcept {
  const double wanted = std::round(perMilleOf(std::clamp(volts, -kLargestVolts, kLargestVolts), units));
  const double limit = std::min(limit_per_mille, 32767);
  return static_cast<std::int16_t>(std::clamp(wanted, -limit, limit));
}

}  // namespace knee_robot::hardware::can
