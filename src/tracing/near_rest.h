#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Fills search.near_rest for the law that the base has now.
void updateNearRest(Search& search);

/// Least squares onto the model as it stands (`effects`), and what other laws near rest would change.
Projection projectModel(const Search& search, const std::vector<Hypothesis>& effects);

/// Those columns: the base's, the effects' in their order, other laws'.
Eigen::MatrixXd projectedColumns(const Search& search, const std::vector<Hypothesis>& effects);

/// Share of the squared noise that friction of one actuator explains beyond the laws near rest that it might have
/// instead. A law is a mixture of shares that are positive: what only their difference explains (dry friction that is
/// larger while creeping) is no law.
double shareBeyondLaws(const Search& search, const Hypothesis& friction);

}  // namespace knee_robot::tracing
