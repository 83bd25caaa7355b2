#pragma once

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// Fills usable, saturated_share and masks of an observation whose signals and motion are there, and says in its notes what was left
/// out. Around every masked sample the reach of the low-pass is left out too.
void maskUnusable(const mechanism::Robot& robot, const ObservationOptions& options, Observation& observation);

/// Fills moving and axis_moving.
void findMoving(const ObservationOptions& options, Observation& observation);

}  // namespace knee_robot::identification
