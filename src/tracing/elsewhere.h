#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Least share of the squares that an effect of a parallel robot must save at held-back positions: less than that may cost more on another
/// path. Right ones on 14 machines of two independent simulators saved half of them or more.
inline constexpr double kWorthElsewhere = 0.05;

/// Held-back stretches of other positions, and samples with a masked pose: what each effect saves there. Effects that
/// do not surely help there are not predicted elsewhere.
void testElsewhere(Search& search, std::vector<std::string>& notes);

/// What was found, as it is to be predicted elsewhere: links held as in the baseline where that may be something else, and
/// without what paths that were left out speak against (holdBackOfPaths).
void settleElsewhere(Search& search, const BaseFit& baseline, std::vector<std::string>& notes);

/// Whether what is predicted elsewhere predicts held-back stretches of other positions surely better than the baseline,
/// with its own laws near rest, does. False where no effect is predicted elsewhere.
bool helpsElsewhere(Search& search, const BaseFit& baseline);

/// What is predicted in other recordings.
struct ElsewhereFit {
  std::vector<FoundEffect> effects;
  Eigen::VectorXd parameters, seen_parameters;
};

/// Fits base and laws near rest without the effects that do not transfer (but for pushes: what they did to training must
/// not go into the parameters), then all effects again on that base: laws that were chosen beside what is left out are
/// wrong, too, and a model has one for all. `keep_laws`: those of a given model, of chains; else they are chosen anew, or
/// those of the baseline.
ElsewhereFit fitElsewhere(Search& search, const BaseFit& baseline, bool keep_laws);

}  // namespace knee_robot::tracing
