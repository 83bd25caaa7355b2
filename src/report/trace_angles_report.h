#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/report/trace_report.h"

namespace knee_robot::report {

/// "angles" of report.json: for every candidate and place the principal angles to the base, and the nearest others.
nlohmann::ordered_json anglesJson(const TraceResults& results);
/// "where" of report.json: share of the squared error that is left while the axis moves, at rest, and in masked
/// samples.
nlohmann::ordered_json errorSharesJson(const TraceResults& results);
/// Lines for the terminal.
std::string anglesSummary(const TraceResults& results);
std::string errorSharesSummary(const TraceResults& results);

}  // namespace knee_robot::report
