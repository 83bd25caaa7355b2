#include <cmath>
#include <random>

#include "earlier_run.h"
#include "knee_robot/base/files.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/recorded_units.h"
#include "knee_robot/report/trace_report.h"
#include "trace_angles_report.h"
#include "trace_given_report.h"
#include "trace_next_report.h"
#include "trace_pose_report.h"
#include "trace_series.h"

namespace knee_robot::report {
namespace {

Json parametersJson(const dynamics::ModelEffect& e) {
  Json j = Json::object();
  for (const auto* group : {&e.shape, &e.coefficients}) {
    for (const dynamics::EffectParameter& p : *group)
      j[p.name] = {{"value", p.value}, {"std", jsonNumber(p.std)}};
  }
  return j;
}

/// A payload that was told against a given model is an effect, though the base parameters carry it.
Json payloadEffect(const tracing::PayloadTest& p, int axes) {
  std::vector<int> actuators;
  for (int i = 1; i <= axes; ++i)
    actuators.push_back(i);
  Json parameters = {{"mass_kg", {{"value", p.mass_kg}, {"std", p.mass_std_kg}}}};
  for (int k = 0; k < 3; ++k)
    parameters[std::string("center_") + "xyz"[k] + "_m"] = {{"value", p.center_m[k]}, {"std", p.center_std_m[k]}};
  return {{"name", "payload"},        {"actuators", actuators}, {"transfers", true},
          {"parameters", parameters}, {"sentence", p.sentence}, {"indistinguishable_from", Json::array()}};
}

Json effectsJson(const TraceResults& r) {
  Json list = Json::array();
  if (r.result.payload.is_effect) list.push_back(payloadEffect(r.result.payload, r.model.axes));
  for (std::size_t k = 0; k < r.result.effects.size(); ++k) {
    const tracing::FoundEffect& e = r.result.effects[k];
    const dynamics::ModelEffect& m = r.model.effects[k];
    Json j = {{"name", e.doubted || e.isOneOfMany() ? "unnamed" : m.name},
              {"actuators", m.actuators},
              {"transfers", m.transfers},
              {"parameters", parametersJson(m)},
              {"explained_rms_N", jsonArray(e.explained_rms_N)},
              {"null_rms_N", jsonArray(e.null_rms_N)},
              {"p", jsonNumber(e.p)},
              {"probability", tracing::probabilityOfName(e)},
              {"probability_against_rivals", e.probability},
              {"held_back_positions_gain", e.elsewhere_gain},
              {"held_back_gain", {{"share", e.gain}, {"standard_error", e.gain_error}}},
              {"validate_gain_N", k < r.validate_gain_N.size() ? jsonArray(r.validate_gain_N[k]) : Json::array()},
              {"indistinguishable_from", e.isOneOfMany() ? std::vector<std::string>() : e.indistinguishable_from},
              {"sentence", e.hypothesis.place.candidate->sentence()}};
    if (e.doubted) j["looks_like"] = m.name;
    if (e.isOneOfMany()) j["not_separable_from"] = e.indistinguishable_from;
    if (!m.depends_on.empty()) j["depends_on"] = {m.depends_on};
    list.push_back(j);
  }
  return list;
}

Json dependsJson(const TraceResults& r) {
  Json list = Json::array();
  for (std::size_t k = 0; k < r.result.effects.size(); ++k) {
    const tracing::FoundEffect& e = r.result.effects[k];
    if (r.model.effects[k].depends_on.empty()) continue;
    for (const int actuator : r.model.effects[k].actuators) {
      const double share = std::pow(e.explained_rms_N[actuator - 1] / r.result.before_rms_N[actuator - 1], 2);
      list.push_back({{"signal", r.model.effects[k].depends_on}, {"actuator", actuator}, {"share", share}});
    }
  }
  return list;
}

Json gainJson(const std::vector<identification::Observation>& observations, const identification::Applied& before,
              const identification::Applied& after) {
  if (observations.empty()) return {};
  const GainInterval g = bootstrapGain(observations, before, after, 1);
  return {{"rms_change_low_N", jsonArray(g.low_N)}, {"rms_change_high_N", jsonArray(g.high_N)}, {"level", 0.95}};
}

/// Squared errors of one actuator in pieces of two seconds, before and after, over all recordings.
std::vector<std::array<double, 3>> pieces(const std::vector<identification::Observation>& observations,
                                          const identification::Applied& before, const identification::Applied& after,
                                          int i) {
  std::vector<std::array<double, 3>> out;
  for (std::size_t f = 0; f < observations.size(); ++f) {
    const identification::Observation& o = observations[f];
    const int length = std::max(1, static_cast<int>(2.0 / o.signals.period_s));
    for (int n = 0; n < o.samples(); ++n) {
      if (n % length == 0) out.push_back({0.0, 0.0, 0.0});
      if (!o.isJudged(n)) continue;
      const double force = o.force_filtered_N(n, i);
      out.back()[0] += std::pow(force - before.predictions[f].force_filtered_N(n, i), 2);
      out.back()[1] += std::pow(force - after.predictions[f].force_filtered_N(n, i), 2);
      out.back()[2] += 1.0;
    }
  }
  return out;
}

}  // namespace

GainInterval bootstrapGain(const std::vector<identification::Observation>& observations,
                           const identification::Applied& before, const identification::Applied& after, unsigned seed) {
  constexpr int kDraws = 400;
  const int axes = observations.front().axes();
  GainInterval g{Eigen::VectorXd(axes), Eigen::VectorXd(axes)};
  for (int i = 0; i < axes; ++i) {
    const auto blocks = pieces(observations, before, after, i);
    std::mt19937_64 random(seed);
    std::vector<double> change;
    for (int d = 0; d < kDraws; ++d) {
      double sum[3] = {0.0, 0.0, 0.0};
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        const auto& block = blocks[random() % blocks.size()];
        for (int c = 0; c < 3; ++c)
          sum[c] += block[static_cast<std::size_t>(c)];
      }
      change.push_back(std::sqrt(sum[1] / sum[2]) - std::sqrt(sum[0] / sum[2]));
    }
    std::sort(change.begin(), change.end());
    g.low_N[i] = change[kDraws / 40];
    g.high_N[i] = change[kDraws - 1 - kDraws / 40];
  }
  return g;
}

std::string traceJson(const TraceResults& r) {
  Json j;
  j["command"] = "trace";
  j["robot"] = r.robot_path;
  j["data"] = dataJson(r.train, r.validate, r.options.observation);
  int added = 0;
  for (const tracing::FoundEffect& e : r.result.effects)
    added += static_cast<int>(e.coefficients.size() + (e.hypothesis.place.candidate->isMap()
                                                           ? 0
                                                           : static_cast<Eigen::Index>(e.hypothesis.shape.size())));
  j["before"] = sideJson(r.result.baseline.decided, r.train_before, r.validate_before);
  j["after"] = sideJson(r.result.base.decided + added, r.train_after, r.validate_after);
  j["effects"] = effectsJson(r);
  const bool validated = !r.validate.empty();
  j["unexplained"] = {{"rms_N", jsonArray((validated ? r.validate_after : r.train_after).accuracy.rms_N)},
                      {"training_rms_N", jsonArray(r.result.after_rms_N)},
                      {"noise_floor_N", jsonArray(r.result.floor_N)},
                      {"noise_floor_source", r.result.floor_source},
                      {"depends_on", dependsJson(r)}};
  j["unexplained"]["where"] = errorSharesJson(r);
  j["angles"] = anglesJson(r);
  if (r.result.payload.tested)
    j["payload"] = {{"stated", r.result.payload.stated},
                    {"mass_kg", r.result.payload.mass_kg},
                    {"std_kg", r.result.payload.mass_std_kg},
                    {"sentence", r.result.payload.sentence}};
  j["pose"] = tracePoseJson(r.pose);
  j["next_experiment"] = nextExperimentJson(r.next);
  if (!r.result.given.path.empty()) j["given_model"] = givenModelJson(r.result.given);
  j["outcome"] = traceOutcome(r);
  j["verdict"] = traceVerdict(r);
  j["gain_interval"] = {{"train", gainJson(r.train, r.train_before, r.train_after)},
                        {"validate", gainJson(r.validate, r.validate_before, r.validate_after)}};
  j["absorbed"] = r.result.absorbed;
  j["friction_near_rest"] = frictionJson(r.model.friction);
  j["friction_tried"] = frictionTriedJson(r.result.baseline.choices);
  j["not_added"] = r.result.rejected;
  j["doubts"] = r.result.doubts;
  j["notes"] = r.result.notes;
  j["seed"] = r.options.seed;
  j["reproduce"] = r.command_line;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeTraceFiles(const TraceResults& r, const std::string& folder) {
  const Page page("trace");
  makeFolder(folder);
  FileSet files;
  const std::vector<std::string> earlier = filesOfEarlierRun(folder, "trace");
  std::vector<std::string> written;
  files.add(folder + "/model.yaml", dynamics::modelToYaml(r.model));
  for (std::size_t i = 0; i < r.validate.size(); ++i) {
    written.push_back("prediction_" + r.validate[i].name + ".csv");
    files.add(folder + "/" + written.back(),
              predictionTable(r.validate[i], r.validate_after.predictions[i], &r.validate_before.predictions[i]));
  }
  addNextExperiment(files, r.next, r.robot_path, folder);
  addReport(files, folder, page, jsonWithUnits(r.units, traceJson(r)), traceSeries(r));
  removeStale(folder, earlier, written);
  files.commit();
}

}  // namespace knee_robot::report
