#pragma once

#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/trace_report.h"

namespace knee_robot::report {

/// What the plots of trace's page show beside report.json: forces of every recording, mean residual over velocity and
/// position, friction around a reversal, the camera's error, and the motion of the next experiment.
Json traceSeries(const TraceResults& results);

}  // namespace knee_robot::report
