#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// What the baseline takes up, so that nobody can tell it from these recordings: into `result.absorbed` with the reason,
/// and places that are the baseline's own columns into search.absorbed. `projection`: onto the baseline without its prior.
void noteWhatIsAbsorbed(Search& search, const Projection& projection, TraceResult& result);

}  // namespace knee_robot::tracing
