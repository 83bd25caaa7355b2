#pragma once

#include <string>

#include "knee_robot/excitation/rest_excitation.h"

namespace knee_robot::nodes {

/// plan_excitation --near-rest: plans the movement, writes it to `output` (a reference file) and prints what it holds.
int planRestExcitation(const mechanism::Robot& robot, const excitation::RestExcitationOptions& options,
                       const std::string& output);

}  // namespace knee_robot::nodes
