#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// A hypothesis whose columns are the whole effect (share_of_forward_model is one), with the shape that makes it so: a
/// coupling half as stiff in the place of twice the change by a stiff one, which the rows hardly tell from it, but no
/// machine has. As it is where that explains clearly less, or the candidate knows no such shape (Candidate::ofSize).
Hypothesis ofWholeSize(const Search& s, const Projection& projection, const Hypothesis& hypothesis);

}  // namespace knee_robot::tracing
