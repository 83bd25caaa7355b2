#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "knee_robot/base/file_set.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::report {

class Page;

using Json = nlohmann::ordered_json;

/// null where a value is not finite.
Json jsonNumber(double value);
Json jsonArray(const Eigen::VectorXd& values);
/// "data" of report.json.
Json dataJson(const std::vector<identification::Observation>& train,
              const std::vector<identification::Observation>& validate,
              const identification::ObservationOptions& options);
/// Figures of one side on one set of recordings.
Json accuracyJson(const identification::Accuracy& accuracy);
/// Laws of friction near rest, one entry per actuator: name, in words, elements.
Json frictionJson(const std::vector<dynamics::FrictionLaw>& laws);
/// "friction_tried" of report.json: the best law of every family that was tried, per actuator.
Json frictionTriedJson(const std::vector<identification::FrictionChoice>& choices);
/// One side ("before" or "after") of report.json.
Json sideJson(int parameters, const identification::Applied& train, const identification::Applied& validate);

/// Adds report.json, and the page that shows it with these series of its plots, report.html.
void addReport(FileSet& files, const std::string& folder, const Page& page, const std::string& report_json,
               const Json& series);

/// prediction_NAME.csv of one recording: time_s, force_i_N as recorded, predicted_i_N, and with `before` before_i_N.
std::string predictionTable(const identification::Observation& observation,
                            const identification::Prediction& prediction, const identification::Prediction* before);

}  // namespace knee_robot::report
