#pragma once

#include "knee_robot/report/json_parts.h"
#include "knee_robot/tuning/tuning_report.h"

namespace knee_robot::tuning {

/// What the plots of the tuning page show, one entry an axis, null where it is not judged: commanded and modelled
/// force, sensitivity and step response of present and proposed gains at the lightest and the heaviest end of the
/// range.
report::Json tuningSeries(const TuningResults& results);

}  // namespace knee_robot::tuning
