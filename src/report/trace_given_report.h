#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/tracing/given_model.h"

namespace knee_robot::report {

/// "given_model" of report.json; null when none was given.
nlohmann::ordered_json givenModelJson(const tracing::GivenModel& given);
/// Lines for the terminal; empty when none was given.
std::string givenModelSummary(const tracing::GivenModel& given);

}  // namespace knee_robot::report
