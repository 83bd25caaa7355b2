#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// A new effect that acts on all actuators may be what an older one of its kind stood for so far, as a curve over a
/// distance does for a strap: with the library's best shape where neither is in the model, refined, it takes the place
/// of both if held-back blocks are predicted as well then, within a standard error.
void replaceKin(Search& search, const Place& place);

/// A map that acts on the platform along all its coordinates (platform_matrices.h) gives way to what it contains that has
/// a name, a damper or a spring that relaxes between two points, where that predicts held-back blocks as well.
void nameMatrix(Search& search, const Place& found);

}  // namespace knee_robot::tracing
