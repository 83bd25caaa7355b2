#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Refines the shapes of all effects together: variable projection, coefficients solved for at every step.
void refineShapes(Search& search);

}  // namespace knee_robot::tracing
