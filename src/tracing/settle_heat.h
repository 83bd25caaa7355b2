#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Decides for all drives that warm up by effects of one kind together what warms them: the clock, unless held-back
/// blocks are predicted surely better by their time in motion or by their work. A sentence; empty: nothing warms up, or
/// the clock is sure.
std::string settleHeat(Search& search, const Candidate* kind);

}  // namespace knee_robot::tracing
