#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/tracing/model_prediction.h"

namespace knee_robot {

/// A model file applied to recordings.
struct PredictResults {
  std::string model_path;
  Model model;
  std::vector<Observation> observations;  ///< at least one
  Applied applied;
};

/// Observes the recordings as the model wants it and predicts them all (predictModel). InputError when model, robot and
/// recordings do not fit together.
PredictResults predictRecordings(const Robot& robot, const Model& model, const std::string& model_path,
                                 const std::vector<Recording>& recordings);

/// What the program prints: the model's effects and the errors per recording and actuator.
std::string predictSummary(const PredictResults& results);
/// prediction_NAME.csv of every recording.
void writePredictFiles(const PredictResults& results, const std::string& folder);

}  // namespace knee_robot
