#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Whether the robot was where it was during a push at other times as well, and what was left there. A push is no
/// property of the machine: it does not come back.
struct Recurrence {
  /// Share of the squares, on the actuator that the push loads most, that what is left elsewhere tells, where any one
  /// actuator is at the same place and the loaded one moves the same way. Near 0, or less, when nothing comes back.
  double share = 0.0;
  /// Share of the push's time in which every actuator is at a place where it is at other times, too (the least over
  /// the actuators): where it is not, what depends on that place cannot be told from a push.
  double covered = 1.0;
};

/// `without_N`: what the model leaves without the push, stacked as the search's rows.
Recurrence recurrenceOf(const Search& search, const Hypothesis& push, const Eigen::VectorXd& without_N);

/// Share of a push's squares that the actuator has which it loads most; 1: it acts on one actuator alone.
double shareOfOneActuator(const Search& search, const Hypothesis& push, const Eigen::VectorXd& coefficients);

}  // namespace knee_robot::tracing
