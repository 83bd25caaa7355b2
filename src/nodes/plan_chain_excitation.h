#pragma once

#include <string>
#include <vector>

#include "knee_robot/excitation/chain_excitation.h"

namespace knee_robot::nodes {

/// plan_excitation of a chain: plans beside what `recorded` already says, writes the joints' motion to `output` (CSV,
/// 100 Hz) and prints what was reached.
int planChainExcitation(mechanism::Robot robot, const std::vector<std::string>& recorded,
                        excitation::ChainExcitationOptions options, const std::string& output);

}  // namespace knee_robot::nodes
