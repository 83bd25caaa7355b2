#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/base/file_set.h"
#include "knee_robot/tracing/next_experiment.h"

namespace knee_robot::report {

inline constexpr const char* kNextExperimentFile = "next_experiment.txt";

/// "next_experiment" of report.json; null when there is nothing to separate.
nlohmann::ordered_json nextExperimentJson(const tracing::NextExperiment& next);
/// Lines for the terminal; empty when there is nothing to separate.
std::string nextExperimentSummary(const tracing::NextExperiment& next);
/// Adds the motion as a reference file in `folder`, when one was planned.
void addNextExperiment(FileSet& files, const tracing::NextExperiment& next, const std::string& robot_path,
                       const std::string& folder);

}  // namespace knee_robot::report
