#include "approach_line.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {

trajectory::Points approachLine(const AxisValues& from_m, const AxisValues& to_m, const mechanism::Robot& robot,
                                double speed_m_per_s) {
  double duration = 0.5;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double distance = std::abs(to_m[i] - from_m[i]);
    // Peaks of the minimum-jerk profile: 1.875 and 5.7735.
    duration = std::max(duration, 1.875 * distance / speed_m_per_s);
    duration = std::max(duration, std::sqrt(5.7735 * distance / (0.5 * robot.actuators[i].acceleration_max_m_per_s2)));
  }
  const auto intervals = static_cast<Eigen::Index>(std::ceil(duration / trajectory::kStreamPeriod));
  trajectory::Points points(intervals + 1, 4);
  for (Eigen::Index k = 0; k <= intervals; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(intervals);
    const double share = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      points(k, static_cast<Eigen::Index>(i)) = from_m[i] + share * (to_m[i] - from_m[i]);
  }
  return points;
}

}  // namespace knee_robot::control
