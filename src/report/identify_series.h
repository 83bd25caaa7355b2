#pragma once

#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {

/// What the plots of identify's page show beside report.json: forces of every recording, spectra of the residual and of
/// the reference, friction around a reversal.
Json identifySeries(const IdentifyResults& results);

}  // namespace knee_robot::report
