#pragma once

#include "knee_robot/tracing/trace_result.h"
#include "search.h"

namespace knee_robot::tracing {

/// Sets what a controller is given (TraceResult::feedforward): base and laws near rest fitted without what `result` predicts in other recordings but has
/// no law instant by instant (effect_law.h). The parameters beside a supply that sags lack what those of the baseline
/// have of it, and in a controller nothing makes up for that. What acts in the training recordings alone, or is the
/// patient's, stays in the fit and out of the model. Where nothing is fed forward but the baseline: the baseline, unless
/// `given` (a model was started from, and the search's baseline is fitted beside its effects). Does nothing where all that
/// is predicted has a law, and to a chain, which no controller drives.
void fitFeedforward(Search& search, TraceResult& result, bool given);

}  // namespace knee_robot::tracing
