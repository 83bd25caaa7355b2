#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::identification {

/// What training recordings must have: each of these throws a Refusal where it is missing.

/// Paths of recordings, for sentences.
std::string namesOf(const std::vector<Observation>& training);

/// Commands that are hardly ever at their limit.
void refuseSaturated(const std::vector<Observation>& training);

/// A motion of every actuator.
void refuseMotionless(const mechanism::Robot& robot, const std::vector<Observation>& training,
                      const ObservationOptions& options);

/// Forces that change where an actuator moves.
void refuseForceless(const mechanism::Robot& robot, const std::vector<Observation>& training,
                     const ObservationOptions& options);

/// Enough samples that are used.
void refuseTooShort(const std::vector<Observation>& training, const Equations& equations,
                    const ObservationOptions& options);

}  // namespace knee_robot::identification
