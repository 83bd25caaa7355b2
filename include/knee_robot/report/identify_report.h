#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/full_band.h"
#include "knee_robot/identification/physical_fit.h"
#include "knee_robot/recording/cutoff.h"
#include "knee_robot/report/recorded_units_of.h"

namespace knee_robot::report {

/// Everything that identify's files say. `before` is the model without actuator friction, `after` the identified one.
struct IdentifyResults {
  RecordedUnits units;       ///< see toRecordedUnits; plain: m and N
  std::string command_line;  ///< that reproduces this
  std::string robot_path;
  identification::IdentifyOptions options;
  recording::CutoffChoice cutoff;      ///< how the low-pass of both sides was chosen
  identification::FullBand full_band;  ///< how fast rows are predicted
  std::vector<identification::Observation> train;
  std::vector<identification::Observation> validate;  ///< may be empty
  identification::Identification before, after;
  std::vector<std::string> drive_gains;  ///< that were estimated, in sentences
  std::vector<std::string> doubts;       ///< whether the model describes its training data at all
  identification::Applied train_before, train_after;
  identification::Applied validate_before, validate_after;  ///< empty without validation recordings
  std::vector<Eigen::VectorXd> train_by_strength;           ///< errorAgainstRank
  std::vector<Eigen::VectorXd> validate_by_strength;        ///< empty without validation recordings

  std::optional<dynamics::RobotInertia> prior;          ///< of the robot's URDF
  std::string urdf_path;                                ///< that the prior came from
  std::optional<mechanism::Chain> chain;                ///< of a chain
  std::optional<identification::PhysicalFit> physical;  ///< when there is a prior
  std::string no_physical;                              ///< why there is none
  identification::Applied train_physical, validate_physical;
};

/// report.json of docs/files.md, with "rank", "parameters" and "signal_path".
std::string identifyJson(const IdentifyResults& results);

/// prediction_NAME.csv of one recording: time_s, force_i_N as recorded, predicted_i_N.
std::string predictionCsv(const identification::Observation& observation, const identification::Prediction& prediction);

/// What the program prints: errors per actuator, and error against rank.
std::string identifySummary(const IdentifyResults& results);

/// Verdict on a parameter for people, from ModelParameter::verdict.
std::string verdictText(const std::string& verdict);

/// The outlier rule in words.
std::string outlierText(identification::OutlierRule rule);

/// Writes model.yaml, report.json, report.html and one prediction_NAME.csv per validation recording into `folder` (made
/// when missing); with a physically consistent fit also model_physical.yaml and identified.urdf. Each file is whole or
/// not there. InputError when it cannot be written.
void writeIdentifyFiles(const IdentifyResults& results, const std::string& folder);

}  // namespace knee_robot::report
