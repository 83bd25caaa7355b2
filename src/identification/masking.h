#pragma once

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// Fills usable, judged, saturated_share and masks of an observation whose signals and motion are there, and says in
/// its notes what was left out. Around every masked sample the reach of the low-pass is left out too.
void maskUnusable(const mechanism::Robot& robot, const ObservationOptions& options, Observation& observation);

/// Says in its notes where positions jump (recording/jumps.h).
void noteJumps(const mechanism::Robot& robot, Observation& observation);

/// Fills moving and axis_moving.
void findMoving(const mechanism::Robot& robot, const ObservationOptions& options, Observation& observation);

/// Speed of one actuator that 95 % of the samples stay below, m/s.
double usualSpeed(const recording::Signals& signals, Eigen::Index actuator);

/// Per actuator the speed (m/s) above which it counts as moving: that of the options; of a chain's joint at most a
/// share of its usual speed, so that a slow one moves too.
Eigen::VectorXd movingLimits(const mechanism::Robot& robot, const ObservationOptions& options,
                             const recording::Signals& signals);

}  // namespace knee_robot::identification
