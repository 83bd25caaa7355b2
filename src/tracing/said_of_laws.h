#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::tracing {

/// Says on which actuators most of the dry friction builds up over a way far longer than an encoder's steps: the
/// baseline's own law near rest has that, and nothing is left to add. Said where every family of laws without such a
/// way is surely worse on held-back blocks; empty where that is so of none.
std::string longPresliding(const std::vector<identification::FrictionChoice>& choices);

/// Says on which actuators friction is larger near rest than beyond (stiction, a hump after a reversal), and by how much
/// of it: the baseline's own law near rest has that. Such laws are chosen only where they are surely better than all
/// others; empty where none was.
std::string peakNearRest(const std::vector<identification::FrictionChoice>& choices);

}  // namespace knee_robot::tracing
