#include "knee_robot/report/json_parts.h"

#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/page.h"

namespace knee_robot::report {
namespace {

Json paths(const std::vector<identification::Observation>& observations) {
  Json list = Json::array();
  for (const identification::Observation& o : observations)
    list.push_back(o.path);
  return list;
}

}  // namespace

Json jsonNumber(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json jsonArray(const Eigen::VectorXd& values) {
  Json list = Json::array();
  for (const double value : values)
    list.push_back(jsonNumber(value));
  return list;
}

Json accuracyJson(const identification::Accuracy& a) {
  return {{"rms_N", jsonArray(a.rms_N)},
          {"rms_moving_N", jsonArray(a.rms_moving_N)},
          {"rms_resting_N", jsonArray(a.rms_resting_N)},
          {"rms_since_moved_N", jsonArray(a.rms_since_moved_N)},
          {"rms_raw_N", jsonArray(a.rms_raw_N)},
          {"raw_percent", jsonArray(a.raw_percent)},
          {"rms_percent", jsonArray(a.rms_percent)},
          {"range_percent", jsonArray(a.range_percent)},
          {"max_N", jsonArray(a.max_N)},
          {"together_percent", jsonNumber(a.togetherPercent())},
          {"samples", a.samples},
          {"moving_samples", a.moving_samples}};
}

Json frictionJson(const std::vector<dynamics::FrictionLaw>& laws) {
  Json list = Json::array();
  for (const dynamics::FrictionLaw& law : laws) {
    Json elements = Json::array();
    for (int k = 0; k < law.count; ++k) {
      const dynamics::FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
      const bool smooth = e.kind == dynamics::FrictionKind::Smooth, stop = e.kind == dynamics::FrictionKind::Stop;
      Json element = {{"law", stop     ? "stop"
                              : smooth ? dynamics::smoothName(e.smooth)
                                       : "bristles"},
                      {"share", e.share}};
      if (!smooth) element["width_m"] = e.width_m;
      if (e.gap_m > 0.0) element["gap_m"] = e.gap_m;
      if (e.relaxation_s > 0.0) element["relaxation_s"] = e.relaxation_s;
      if (e.lag_s > 0.0) element["lag_s"] = e.lag_s;
      if (!stop) element["speed_m_per_s"] = e.speed_m_per_s;
      if (!stop && !smooth) element["damping_s"] = e.damping_s;
      if (e.tremble > 0.0) element["tremble"] = e.tremble;
      if (e.exponent != 1.0) element["exponent"] = e.exponent;
      elements.push_back(element);
    }
    list.push_back({{"law", dynamics::nameOf(law)}, {"in_words", dynamics::describe(law)}, {"elements", elements}});
    if (law.at_start != 0.0) list.back()["at_start"] = law.at_start;
  }
  return list;
}

Json frictionTriedJson(const std::vector<identification::FrictionChoice>& choices) {
  Json list = Json::array();
  for (const identification::FrictionChoice& choice : choices) {
    Json tried = Json::array();
    bool chosen = false;  // the simpler one, where two families end at one law
    for (const identification::TriedLaw& t : choice.tried) {
      const bool this_one = !chosen && t.law == choice.law;
      chosen = chosen || this_one;
      tried.push_back({{"in_words", dynamics::describe(t.law)},
                       {"chosen", this_one},
                       {"held_back", t.held_back},
                       {"beyond_best", t.beyond_best},
                       {"standard_error", t.standard_error}});
    }
    list.push_back(tried);
  }
  return list;
}

Json dataJson(const std::vector<identification::Observation>& train,
              const std::vector<identification::Observation>& validate,
              const identification::ObservationOptions& options) {
  int samples = 0;
  for (const identification::Observation& o : train)
    samples += o.judgedSamples();
  return {{"train", paths(train)},
          {"validate", paths(validate)},
          {"rate_hz", 1.0 / train.front().signals.period_s},
          {"samples", samples},
          {"cutoff_hz", options.cutoff_hz},
          {"moving_m_per_s", options.moving_m_per_s},
          {"evidence_across_trajectories", train.size() > 1}};
}

Json sideJson(int parameters, const identification::Applied& train, const identification::Applied& validate) {
  Json j = {{"parameters", parameters}, {"train", accuracyJson(train.accuracy)}};
  j["validate"] = validate.predictions.empty() ? Json() : accuracyJson(validate.accuracy);
  return j;
}

void addReport(FileSet& files, const std::string& folder, const Page& page, const std::string& report_json,
               const Json& series) {
  files.add(folder + "/report.json", report_json);
  const std::string embedded = Json::parse(report_json).dump();  // without its indents
  files.add(folder + "/report.html", page.with(embedded, series.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

std::string predictionTable(const identification::Observation& o, const identification::Prediction& prediction,
                            const identification::Prediction* before) {
  const Eigen::Index axes = o.row_force_N.cols();
  std::string csv = "time_s";
  for (const char* name : {"force_", "predicted_", "before_"}) {
    if (before == nullptr && std::string(name) == "before_") continue;
    for (Eigen::Index i = 1; i <= axes; ++i) {
      const std::string unit = o.force_unit.empty() ? "N" : o.force_unit[static_cast<std::size_t>(i - 1)];
      const char* const effort = unit == "A" ? "current_" : unit == "Nm" ? "torque_" : "force_";
      csv += "," + ((std::string(name) == "force_" ? effort : name) + std::to_string(i)) + "_" + unit;
    }
  }
  csv += "\n";
  for (std::size_t row = 0; row < o.row_time_s.size(); ++row) {
    const Eigen::Index n = static_cast<Eigen::Index>(row);
    csv += exactNumber(o.row_time_s[row]);
    for (Eigen::Index i = 0; i < axes; ++i)
      csv += "," + exactNumber(o.row_force_N(n, i));
    for (const identification::Prediction* p : {&prediction, before}) {
      for (Eigen::Index i = 0; p != nullptr && i < axes; ++i)
        csv += "," + shortNumber(p->row_force_N(n, i), 9);
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace knee_robot::report
