#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Gives actuators back the laws near rest that the baseline chose without effects, where held-back blocks are surely
/// predicted better by them, all samples alike. Beside an effect that is not quite the true one the choice of a law, in
/// which samples at rest count little, may let go of the part that shows there alone. True when a law has changed.
bool settleLaws(Search& search, const BaseFit& baseline);

}  // namespace knee_robot::tracing
