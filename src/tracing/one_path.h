#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// The baseline does not describe the one path that was seen (one recording, or several that follow the same): what was
/// found beside it may be anything. `doubts`: TraceResult::doubts.
bool isOnePathNotDescribed(const std::vector<std::string>& doubts,
                           const std::vector<identification::Observation>& recordings);

/// Of every recording the number of the path that it follows, from 0 on in the order of the recordings.
std::vector<int> pathsOf(const std::vector<identification::Observation>& recordings);

/// A force that depends on the pose alone, seen along one path only, in a model that leaves much more than the noise
/// floor: what it stands for (a cable chain's hysteresis, a memory) may be another force in the same pose on another
/// path. So may what has two names or more and may be unnamed; what acts on all actuators and has two names (where no
/// repeat measures the floor, whatever is left); and several maps that together do not reach the floor of
/// repeats: along one path everything is a function of anything. Held-back pieces of the one path cannot tell. Such
/// effects are not predicted elsewhere.
void holdBackOnePath(Search& search, std::vector<std::string>& notes);

}  // namespace knee_robot::tracing
