#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// The same of a chain, whose reports name nothing that fails there: it is taken out, the most harmful one first.
void abstainElsewhere(Search& search, std::vector<std::string>& notes);

/// Takes out ripples, pushes and thermal drifts that explain less than a noise floor on every actuator, and unnamed
/// maps below two, but for those that themselves help at held-back positions where the whole surely does (`helps`); and
/// anything below one that does not help there. What goes with time or happened once must, where no floor was measured by
/// repeats, explain what is left, too. Returns how many; the fit is not done anew.
int leaveOutSmall(Search& search, bool helps, std::vector<std::string>& rejected);

}  // namespace knee_robot::tracing
