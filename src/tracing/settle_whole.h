#pragma once

#include <vector>

#include "trial.h"

namespace knee_robot::tracing {

/// Tries effects that a forward model says (isWhole), the best of each candidate, with a baseline that has given back what
/// it had taken of them, which a single fit does not show: what a soft leg changes is calculated with parameters that
/// contain half of it. Costs several fits each: for when nothing else is left. The trials then say what each explains
/// so, share and held-back gains; the model stays as it is. False: there are none.
bool settleWhole(Search& s, std::vector<Trial>& trials);

}  // namespace knee_robot::tracing
