#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// An effect that depends on a position which always went with another one in training is seen, but not what it depends
/// on: on another path, where the two part, it would predict anything. Such effects are not predicted elsewhere.
void holdBackAmbiguous(Search& search, std::vector<std::string>& notes);

}  // namespace knee_robot::tracing
