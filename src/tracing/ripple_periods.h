#pragma once

#include <utility>

#include "search.h"

namespace knee_robot::tracing {

/// Where a ripple has others of its kind on the same actuator: true when its period differs from one of theirs by less
/// than two turns along the way. Such a one is the other's, whose amplitude changes along the way (a load, a worn
/// place).
bool periodCoincides(const Search& search, const Hypothesis& ripple);

/// Bounds (m) between which the period of a found ripple may be refined without coming nearer to another of its kind
/// on the actuator, when that may come towards it as far. Zero and infinity where it has none, none for other effects.
std::pair<double, double> roomOfPeriod(const Search& search, std::size_t effect);

}  // namespace knee_robot::tracing
