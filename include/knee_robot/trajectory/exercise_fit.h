#pragma once

#include "knee_robot/trajectory/exercises.h"

namespace knee_robot::trajectory {

/// The nearest limit along the whole way of one repetition from `start` (every 2 mm or 0.5 deg, and both ends of each
/// stroke).
Margin nearestOnWay(const Exercise& exercise, const mechanism::Robot& robot, const mechanism::Pose& start,
                    double amplitude);

/// The start pose from which the exercise keeps furthest from all limits; when it does not fit from anywhere, the start
/// from which the largest share of it does. Searched on a grid over Xm (unless the exercise fixes it), Zm and, where
/// level poses do not serve, theta and psi, then refined. Coordinates that the exercise turns about start at zero.
mechanism::Pose startThatFitsMost(const Exercise& exercise, const mechanism::Robot& robot, double amplitude);

/// The largest amplitude up to `asked` that fits from `start`, by bisection to 0.1 %, rounded down to three digits; 0
/// when none.
double largestAmplitude(const Exercise& exercise, const mechanism::Robot& robot, const mechanism::Pose& start,
                        double asked);

}  // namespace knee_robot::trajectory
