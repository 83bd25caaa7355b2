#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Two kinds of effects on the same actuators may be one: load-dependent friction beside another friction each way is
/// what friction by the direction of power flow leaves where loads hardly change. What generalizes an older kind takes
/// the place of it and of the kind that was found last, on all their actuators together, where held-back blocks are
/// surely predicted better then; where they are predicted as well, within a standard error, it is a rival of both names.
void replacePair(Search& search, const Candidate* found);

}  // namespace knee_robot::tracing
