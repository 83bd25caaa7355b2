#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/equations.h"

namespace knee_robot::identification {

/// Forces that are an order of magnitude off what the links' weight and inertia by the URDF (without one: those of usual
/// bodies) ask along the recorded motion: kilonewtons, volts in a column of newtons. Empty: none is. Only forces that
/// follow those of the links are judged: friction says nothing of units.
std::string doubtAboutUnits(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<Observation>& training);

}  // namespace knee_robot::identification
