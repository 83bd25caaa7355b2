#pragma once

#include <limits>

namespace knee_robot {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTwoPi = 2.0 * kPi;
constexpr double kDegree = kPi / 180.0;   ///< in radians
constexpr double kDegrees = 180.0 / kPi;  ///< in a radian
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace knee_robot
