#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// Which recordings that took no part in the fit leave the places of training: poses of the platform, or positions of
/// single axes. A model is a guess there, the more the more effects it has whose force depends on the place. One
/// sentence a recording, in order; empty for one that stays within a tenth of training's ranges, or hardly ever leaves
/// them.
std::vector<std::string> beyondTraining(const mechanism::Robot& robot, const std::vector<Observation>& training,
                                        const std::vector<Observation>& validation);

}  // namespace knee_robot::identification
