#include "knee_robot/report/predict_report.h"

#include <algorithm>

#include "force_series.h"
#include "knee_robot/base/files.h"
#include "knee_robot/identification/full_band.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/recorded_units.h"
#include "number_row.h"

namespace knee_robot::report {

PredictResults predictRecordings(const mechanism::Robot& robot, const dynamics::Model& model,
                                 const std::string& model_path, const std::vector<recording::Recording>& recordings) {
  dynamics::requireModelOf(model, model_path, robot);
  PredictResults r;
  r.robot_path = robot.path;
  r.model_path = model_path;
  r.model = model;
  for (const recording::Recording& recording : recordings) {
    r.observations.push_back(identification::observe(robot, identification::columnsOf(robot), recording,
                                                     tracing::observationOptions(model)));
    identification::Observation& o = r.observations.back();
    r.applied.predictions.push_back(
        identification::makePrediction(o, tracing::predictModel(robot, model, model_path, o), model.cutoff_hz));
    if (model.motion_cutoff_hz == 0.0) continue;
    r.applied.predictions.back().row_force_N = identification::predictRows(
        robot, identification::columnsOf(robot), recording, tracing::observationOptions(model), model.motion_cutoff_hz,
        [&](identification::Observation& along, int) { return tracing::predictModel(robot, model, model_path, along); },
        -1);
  }
  r.applied.accuracy = identification::accuracyOf(r.observations, r.applied.predictions);
  return r;
}

namespace {

bool isOwn(const PredictResults& r, const identification::Observation& o) {
  return std::any_of(r.model.data.begin(), r.model.data.end(),
                     [&](const dynamics::ModelData& data) { return data.fingerprint == o.fingerprint; });
}

Json effectsJson(const dynamics::Model& model) {
  Json list = Json::array();
  for (const dynamics::ModelEffect& e : model.effects)
    list.push_back({{"name", e.name}, {"actuators", e.actuators}, {"transfers", e.transfers}});
  return list;
}

Json predictSeries(const PredictResults& r) {
  Json j = {{"recordings", Json::array()}};
  for (std::size_t k = 0; k < r.observations.size(); ++k)
    j["recordings"].push_back(forceSeries("predict", r.observations[k], r.applied.predictions[k], nullptr));
  return j;
}

}  // namespace

std::string predictJson(const PredictResults& r) {
  Json j = {{"command", "predict"},           {"robot", r.robot_path},
            {"model", r.model_path},          {"effects", effectsJson(r.model)},
            {"cutoff_hz", r.model.cutoff_hz}, {"moving_m_per_s", r.model.moving_m_per_s},
            {"recordings", Json::array()}};
  for (std::size_t k = 0; k < r.observations.size(); ++k) {
    const identification::Observation& o = r.observations[k];
    Json one = {{"path", o.path}, {"name", o.name}, {"fitted_on_it", isOwn(r, o)}};
    one.update(accuracyJson(identification::accuracyOf({o}, {r.applied.predictions[k]})));
    one["notes"] = o.notes;
    j["recordings"].push_back(one);
  }
  j["reproduce"] = r.command_line;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string predictSummary(const PredictResults& r) {
  std::string out = r.model_path + (r.model.effects.empty() ? ": no effects beyond rigid body and friction" : ": with");
  for (std::size_t k = 0; k < r.model.effects.size(); ++k) {
    const dynamics::ModelEffect& e = r.model.effects[k];
    out += (k ? ", " : " ") + e.name;
    if (e.actuators.size() == 1) out += " on actuator " + std::to_string(e.actuators.front());
    if (!e.transfers) out += " (on its own recordings only)";
  }
  out += "\n";
  for (std::size_t k = 0; k < r.observations.size(); ++k) {
    const identification::Observation& o = r.observations[k];
    const bool own = isOwn(r, o);
    const identification::Accuracy a = identification::accuracyOf({o}, {r.applied.predictions[k]});
    out += o.name + (own ? " (the model was fitted on it)" : "") + ", rms, N\n";
    out += numberRow("all samples", a.rms_N) + numberRow("moving samples", a.rms_moving_N);
    out += numberRow("% of the force's rms", a.rms_percent);
    out += numberRow("rows, full band", a.rms_raw_N);
  }
  return out;
}

void writePredictFiles(const PredictResults& r, const std::string& folder) {
  const Page page("predict");
  makeFolder(folder);
  FileSet files;
  for (std::size_t k = 0; k < r.observations.size(); ++k) {
    const identification::Observation& o = r.observations[k];
    files.add(folder + "/prediction_" + o.name + ".csv", predictionTable(o, r.applied.predictions[k], nullptr));
  }
  addReport(files, folder, page, jsonWithUnits(r.units, predictJson(r)), predictSeries(r));
  files.commit();
}

}  // namespace knee_robot::report
