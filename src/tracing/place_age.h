#pragma once

#include <Eigen/Core>

namespace knee_robot::tracing {

/// Longest age that is told apart, s: what a place remembers of the nut's last visit is gone by then, and nobody knows
/// when it was visited before the recording.
inline constexpr double kOldest_s = 60.0;

/// How long ago an actuator was last where it is now, s: the time between leaving a millimetre of the stroke and coming
/// back to it, the same for as long as it stays there; kOldest_s for a place that it has not been to in this recording.
/// Grease that was wiped away and comes back, a seal that ages where it rests, depend on this. `position_m` at equal
/// periods.
Eigen::VectorXd placeAge(const Eigen::VectorXd& position_m, double period_s);

}  // namespace knee_robot::tracing
