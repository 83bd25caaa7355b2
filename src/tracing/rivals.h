#pragma once

#include <string>
#include <vector>

#include "trial.h"

namespace knee_robot::tracing {

/// Rivals of the best trial: other names that explain the same actuator's held-back blocks nearly as well, and
/// "unnamed" where a map explains them better. `probability`: of its name.
std::vector<std::string> rivalsOf(const Search& search, const Trial& best, const std::vector<Trial>& trials,
                                  bool sibling, double& probability);

/// Asks anew, beside all that has been found since and by the laws near rest that were chosen beside it, for names that
/// had a rival, or were doubted because a map would do as well: what was not explained yet bent towards those.
void reconsiderRivals(Search& search);

}  // namespace knee_robot::tracing
