#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Decides for all effects of one kind whether their friction builds up near rest by the actuators' law or by a smooth
/// one of its own:
/// either way the actuators' law is chosen anew beside it, and held-back blocks compare. True when that law may have
/// changed.
bool settleRestLaw(Search& search, const Candidate* kind);

}  // namespace knee_robot::tracing
