#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Writes into the result what the search has found and fitted.
void keepFit(Search& s, TraceResult& result);

/// Decides what other recordings are predicted with: all that was found, those effects that transfer, or the baseline.
/// Where it is not all of it, `result.elsewhere` is set.
void predictElsewhere(const mechanism::Robot& robot, Search& s, TraceResult& result);

}  // namespace knee_robot::tracing
