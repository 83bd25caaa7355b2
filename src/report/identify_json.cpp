#include <cmath>
#include <nlohmann/json.hpp>

#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/identify_report.h"

namespace knee_robot {
namespace {

using Json = nlohmann::ordered_json;

Json array(const Eigen::VectorXd& values) {
  Json list = Json::array();
  for (const double value : values)
    list.push_back(std::isfinite(value) ? Json(value) : Json());
  return list;
}

Json accuracyJson(const Accuracy& a) {
  return {{"rms_N", array(a.rms_N)},
          {"rms_moving_N", array(a.rms_moving_N)},
          {"rms_raw_N", array(a.rms_raw_N)},
          {"rms_percent", array(a.rms_percent)},
          {"range_percent", array(a.range_percent)},
          {"max_N", array(a.max_N)},
          {"samples", a.samples},
          {"moving_samples", a.moving_samples}};
}

Json modelJson(const Identification& id, const Applied& train, const Applied& validate) {
  Json j = {{"parameters", id.model.rank}, {"train", accuracyJson(train.accuracy)}};
  j["validate"] = validate.predictions.empty() ? Json() : accuracyJson(validate.accuracy);
  return j;
}

Json paths(const std::vector<Observation>& observations) {
  Json list = Json::array();
  for (const Observation& o : observations)
    list.push_back(o.path);
  return list;
}

Json rankJson(const IdentifyResults& r) {
  Json curve = Json::array();
  for (std::size_t k = 0; k < r.after.rank.curve.size(); ++k) {
    const RankPoint& p = r.after.rank.curve[k];
    Json point = {{"rank", p.rank},
                  {"held_back", p.held_back},
                  {"beyond_best", p.beyond_best},
                  {"standard_error", p.standard_error},
                  {"train_moving_N", array(r.train_by_rank[k])}};
    if (!r.validate_by_rank.empty()) point["validate_moving_N"] = array(r.validate_by_rank[k]);
    curve.push_back(point);
  }
  return {{"chosen", r.after.model.rank},
          {"rule", "smallest rank whose held-back error is within one standard error of the best"},
          {"blocks", r.after.blocks},
          {"curve", curve}};
}

Json parametersJson(const Model& model) {
  Json list = Json::array();
  for (const ModelParameter& p : model.parameters) {
    if (!std::isfinite(p.std)) continue;
    list.push_back({{"name", p.name}, {"unit", p.unit}, {"value", p.value}, {"std", p.std}, {"verdict", p.verdict}});
  }
  return list;
}

Json notesJson(const IdentifyResults& r) {
  Json j = Json::object();
  for (const auto* group : {&r.train, &r.validate}) {
    for (const Observation& o : *group)
      j[o.path] = o.notes;
  }
  return j;
}

}  // namespace

std::string identifyJson(const IdentifyResults& r) {
  int samples = 0;
  for (const Observation& o : r.train)
    samples += o.samples();
  Json j;
  j["command"] = "identify";
  j["data"] = {{"train", paths(r.train)},
               {"validate", paths(r.validate)},
               {"rate_hz", 1.0 / r.train.front().signals.period_s},
               {"samples", samples},
               {"cutoff_hz", r.options.observation.cutoff_hz},
               {"moving_m_per_s", r.options.observation.moving_m_per_s},
               {"evidence_across_trajectories", r.train.size() > 1}};
  j["before"] = modelJson(r.before, r.train_before, r.validate_before);
  j["before"]["model"] = "without actuator friction";
  j["after"] = modelJson(r.after, r.train_after, r.validate_after);
  j["after"]["model"] = "with actuator friction";
  j["effects"] = Json::array();
  const bool validated = !r.validate.empty();
  j["unexplained"] = {{"rms_N", array((validated ? r.validate_after : r.train_after).accuracy.rms_N)},
                      {"noise_floor_N", Json::array()},
                      {"depends_on", Json::array()}};
  j["pose"] = Json();
  j["next_experiment"] = Json();
  j["rank"] = rankJson(r);
  j["parameters"] = parametersJson(r.after.model);
  j["coulomb_width_m"] = r.after.model.coulomb_width_m;
  j["noise_N"] = array(r.after.noise_N);
  j["outlier_share"] = r.after.outlier_share;
  j["signal_path"] = notesJson(r);
  j["reproduce"] = r.command_line;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string predictionCsv(const Observation& o, const Prediction& p) {
  const Eigen::Index axes = o.row_force_N.cols();
  std::string csv = "time_s";
  for (Eigen::Index i = 1; i <= axes; ++i)
    csv += ",force_" + std::to_string(i) + "_N";
  for (Eigen::Index i = 1; i <= axes; ++i)
    csv += ",predicted_" + std::to_string(i) + "_N";
  csv += "\n";
  for (std::size_t row = 0; row < o.row_time_s.size(); ++row) {
    const Eigen::Index n = static_cast<Eigen::Index>(row);
    csv += exactNumber(o.row_time_s[row]);
    for (Eigen::Index i = 0; i < axes; ++i)
      csv += "," + exactNumber(o.row_force_N(n, i));
    for (Eigen::Index i = 0; i < axes; ++i)
      csv += "," + shortNumber(p.row_force_N(n, i), 9);
    csv += "\n";
  }
  return csv;
}

void writeIdentifyFiles(const IdentifyResults& r, const std::string& folder) {
  makeFolder(folder);
  saveModel(r.after.model, folder + "/model.yaml");
  for (std::size_t i = 0; i < r.validate.size(); ++i) {
    writeFileAtomically(folder + "/prediction_" + r.validate[i].name + ".csv",
                        predictionCsv(r.validate[i], r.validate_after.predictions[i]));
  }
  writeFileAtomically(folder + "/report.json", identifyJson(r));
  writeFileAtomically(folder + "/report.html", identifyHtml(r));
}

}  // namespace knee_robot
