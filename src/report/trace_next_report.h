#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/tracing/next_experiment.h"

namespace knee_robot::report {

inline constexpr const char* kNextExperimentFile = "next_experiment.txt";

/// "next_experiment" of report.json; null when there is nothing to separate.
nlohmann::ordered_json nextExperimentJson(const tracing::NextExperiment& next);
/// Lines for the terminal; empty when there is nothing to separate.
std::string nextExperimentSummary(const tracing::NextExperiment& next);
/// Writes the motion as a reference file into `folder`, when one was planned.
void writeNextExperiment(const tracing::NextExperiment& next, const std::string& robot_path, const std::string& folder);

}  // namespace knee_robot::report
