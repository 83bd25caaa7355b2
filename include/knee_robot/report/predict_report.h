#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/report/recorded_units_of.h"
#include "knee_robot/tracing/model_prediction.h"

namespace knee_robot::report {

/// A model file applied to recordings.
struct PredictResults {
  RecordedUnits units;       ///< see toRecordedUnits; plain: m and N
  std::string command_line;  ///< that reproduces this
  std::string robot_path, model_path;
  dynamics::Model model;
  std::vector<identification::Observation> observations;  ///< at least one
  identification::Applied applied;
};

/// Observes the recordings as the model wants it and predicts them all (predictModel). InputError when model, robot and
/// recordings do not fit together.
PredictResults predictRecordings(const mechanism::Robot& robot, const dynamics::Model& model,
                                 const std::string& model_path, const std::vector<recording::Recording>& recordings);

/// What the program prints: the model's effects and the errors per recording and actuator.
std::string predictSummary(const PredictResults& results);
/// report.json: errors per recording and actuator.
std::string predictJson(const PredictResults& results);
/// prediction_NAME.csv of every recording, report.json, report.html.
void writePredictFiles(const PredictResults& results, const std::string& folder);

}  // namespace knee_robot::report
