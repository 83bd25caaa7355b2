#pragma once

#include <cstdint>

#include "knee_robot/base/constants.h"

namespace knee_robot::hardware::can {

/// From the set value of an axis to that of its drive. The set value is in volts, as for the analog cards, so that a
/// robot file means the same on both: force = volts * force_per_volt_N.
struct AxisUnits {
  double force_per_volt_N = 0.0;  ///< as in the robot file
  double screw_lead_m = 0.0;      ///< metres per motor revolution
  double rated_torque_Nm = 0.0;   ///< what 1000 per mille of object 6071 are
};

/// Torque at the motor that gives this force at a screw without losses.
constexpr double torqueOf(double force_N, double screw_lead_m) noexcept {
  return force_N * screw_lead_m / kTwoPi;
}
/// Per mille of the rated torque, not rounded.
constexpr double perMilleOf(double volts, const AxisUnits& units) noexcept {
  return torqueOf(volts * units.force_per_volt_N, units.screw_lead_m) / units.rated_torque_Nm * 1000.0;
}
constexpr double voltsOf(double per_mille, const AxisUnits& units) noexcept {
  return per_mille / 1000.0 * units.rated_torque_Nm * kTwoPi / units.screw_lead_m / units.force_per_volt_N;
}

/// Set values beyond are clamped, as the analog card does.
inline constexpr double kLargestVolts = 10.0;

/// Nearest whole per mille of a finite set value, after clamping to kLargestVolts and to +-limit.
std::int16_t toPerMille(double volts, const AxisUnits& units, int limit_per_mille) noexcept;

}  // namespace knee_robot::hardware::can
