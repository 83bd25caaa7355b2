#pragma once

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/recorded_units_of.h"

namespace knee_robot::report {

/// A recording's forces for the page, low-passed as they were compared: measured and predicted, and what is left, now
/// and (if there is one) with the simpler model `before`. `kind`: "train", "validate", "predict".
Json forceSeries(const char* kind, const identification::Observation& observation,
                 const identification::Prediction& prediction, const identification::Prediction* before);

/// The same of every one of `observations`, with the model before and after, at the end of `list`.
void appendForceSeries(const char* kind, const std::vector<identification::Observation>& observations,
                       const identification::Applied& before, const identification::Applied& after, Json& list);

/// Share of Coulomb friction around a reversal of the motion, per actuator.
Json frictionSeries(const std::vector<dynamics::FrictionLaw>& laws, const RecordedUnits& units);

}  // namespace knee_robot::report
