#include <cmath>

#include "earlier_run.h"
#include "identify_series.h"
#include "knee_robot/base/files.h"
#include "knee_robot/dynamics/urdf_inertia.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/recorded_units.h"

namespace knee_robot::report {
namespace {

Json strengthJson(const IdentifyResults& r) {
  Json curve = Json::array();
  for (std::size_t k = 0; k < r.after.prior.curve.size(); ++k) {
    const identification::StrengthPoint& p = r.after.prior.curve[k];
    Json point = {{"rank", p.rank},
                  {"held_back", p.held_back},
                  {"training", p.training},
                  {"beyond_best", p.beyond_best},
                  {"standard_error", p.standard_error},
                  {"largest_change", p.largest_change},
                  {"believed", p.believed},
                  {"train_moving_N", jsonArray(r.train_by_strength[k])}};
    if (!r.validate_by_strength.empty()) point["validate_moving_N"] = jsonArray(r.validate_by_strength[k]);
    curve.push_back(point);
  }
  return {{"chosen", r.after.model.rank},
          {"rule",
           "strongest pull towards the prior whose held-back error is within one standard error of the best, of those "
           "that leave the links within three times what the URDF says, where there is one"},
          {"blocks", r.after.blocks},
          {"curve", curve}};
}

Json parametersJson(const dynamics::Model& model) {
  Json list = Json::array();
  for (const dynamics::ModelParameter& p : model.parameters) {
    const bool own = std::isfinite(p.std);
    list.push_back({{"name", p.name},
                    {"unit", p.unit},
                    {"value", own ? Json(p.value) : Json()},
                    {"std", jsonNumber(p.std)},
                    {"verdict", verdictText(p.verdict)}});
  }
  return list;
}

/// The full parameters; "share" is how much of each value the data decide, where they decide it alone.
Json physicalJson(const IdentifyResults& r) {
  if (!r.physical) return {{"done", false}, {"why", r.no_physical}};
  const identification::PhysicalFit& fit = *r.physical;
  Json curve = Json::array();
  for (const identification::PhysicalPoint& p : fit.curve) {
    curve.push_back({{"prior_strength", p.strength},
                     {"directions_from_data", p.supported},
                     {"held_back", p.held_back},
                     {"beyond_best", p.beyond_best},
                     {"standard_error", p.standard_error}});
  }
  Json links = Json::array();
  for (const identification::PhysicalBody& one : fit.bodies) {
    const dynamics::LinkInertia& body = one.fitted;
    const mechanism::Vector3 moments = dynamics::principalMoments(body);
    links.push_back({{"link", one.name},
                     {"mass_kg", body.mass},
                     {"center_m", {body.center.x(), body.center.y(), body.center.z()}},
                     {"principal_moments_kg_m2", {moments.x(), moments.y(), moments.z()}},
                     {"prior_mass_kg", one.prior.mass},
                     {"prior_center_m", {one.prior.center.x(), one.prior.center.y(), one.prior.center.z()}},
                     {"change_from_prior", one.moved},
                     {"possible", dynamics::inconsistency(body).empty()}});
  }
  Json j = {{"done", true},
            {"prior", r.urdf_path},
            {"prior_strength", fit.strength},
            {"directions_from_data", fit.supported},
            {"optimal", fit.optimal},
            {"rule", "strongest prior whose held-back error is within one standard error of the best"},
            {"curve", curve},
            {"links", links}};
  j.update(sideJson(static_cast<int>(std::lround(fit.supported)), r.train_physical, r.validate_physical));
  return j;
}

/// What the fit rests on.
Json fitJson(const IdentifyResults& r) {
  Json j = {{"equations", r.after.equations},
            {"duration_s", r.after.duration_s},
            {"outliers", outlierText(r.options.outliers)}};
  j["given_motion_cutoff_hz"] =
      r.options.observation.motion_cutoff_given ? Json(r.options.observation.signals.motion_cutoff_hz) : Json();
  return j;
}

Json notesJson(const IdentifyResults& r) {
  Json j = Json::object();
  for (const auto* group : {&r.train, &r.validate}) {
    for (const identification::Observation& o : *group)
      j[o.path] = o.notes;
  }
  return j;
}

Json masksJson(const IdentifyResults& r) {
  Json j = Json::object();
  for (const auto* group : {&r.train, &r.validate}) {
    for (const identification::Observation& o : *group) {
      for (const identification::Mask& mask : o.masks)
        j[o.path][mask.reason] = mask.share;
    }
  }
  return j;
}

}  // namespace

std::string identifyJson(const IdentifyResults& r) {
  Json j;
  j["command"] = "identify";
  j["robot"] = r.robot_path;
  j["data"] = dataJson(r.train, r.validate, r.options.observation);
  j["before"] = sideJson(r.before.model.rank, r.train_before, r.validate_before);
  j["before"]["model"] = "without actuator friction";
  j["after"] = sideJson(r.after.model.rank, r.train_after, r.validate_after);
  j["after"]["model"] = "with actuator friction";
  j["effects"] = Json::array();
  const bool validated = !r.validate.empty();
  j["unexplained"] = {{"rms_N", jsonArray((validated ? r.validate_after : r.train_after).accuracy.rms_N)},
                      {"noise_floor_N", Json::array()},
                      {"depends_on", Json::array()}};
  j["pose"] = Json();
  j["next_experiment"] = Json();
  j["rank"] = strengthJson(r);
  j["parameters"] = parametersJson(r.after.model);
  j["combinations"] = r.after.model.base.size();
  j["cutoff"] = {{"rule", r.cutoff.sentence},
                 {"drive_hz", jsonNumber(r.cutoff.drive_hz)},
                 {"follow_hz", jsonNumber(r.cutoff.follow_hz)}};
  j["full_band"] = {{"rule", r.full_band.sentence}, {"motion_cutoff_hz", jsonNumber(r.after.model.motion_cutoff_hz)}};
  j["uncertainty"] = {{"method", "bootstrap of contiguous blocks"}, {"block_s", r.after.bootstrap_block_s}};
  j["physical"] = physicalJson(r);
  j["friction_near_rest"] = frictionJson(r.after.model.friction);
  j["friction_tried"] = frictionTriedJson(r.after.friction);
  j["residual_moving_N"] = r.after.model.residual_rms_N;
  j["noise_N"] = jsonArray(r.after.noise_N);
  j["fit"] = fitJson(r);
  j["outlier_share"] = r.after.outlier_share;
  j["masks"] = masksJson(r);
  j["signal_path"] = notesJson(r);
  j["doubts"] = r.doubts;
  if (!r.drive_gains.empty()) j["drive_gains"] = r.drive_gains;
  j["reproduce"] = r.command_line;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string predictionCsv(const identification::Observation& o, const identification::Prediction& p) {
  return predictionTable(o, p, nullptr);
}

void writeIdentifyFiles(const IdentifyResults& r, const std::string& folder) {
  const Page page("identify");
  makeFolder(folder);
  FileSet files;
  const std::vector<std::string> earlier = filesOfEarlierRun(folder, "identify");
  std::vector<std::string> written;
  files.add(folder + "/model.yaml", dynamics::modelToYaml(r.after.model));
  if (r.physical) {
    files.add(folder + "/model_physical.yaml", dynamics::modelToYaml(r.physical->model));
    const std::string note =
        "Inertias identified from recordings, with those of the given URDF where the recordings say nothing; rotor "
        "inertia is in model_physical.yaml.";
    std::vector<dynamics::LinkInertia> bodies;
    for (const identification::PhysicalBody& one : r.physical->bodies)
      bodies.push_back(one.fitted);
    const std::string urdf = r.chain ? dynamics::urdfWithChainInertia(r.urdf_path, *r.chain, bodies, note)
                                     : dynamics::urdfWithInertia(r.urdf_path, r.physical->inertia, note);
    files.add(folder + "/identified.urdf", urdf);
    written = {"model_physical.yaml", "identified.urdf"};
  }
  for (std::size_t i = 0; i < r.validate.size(); ++i) {
    written.push_back("prediction_" + r.validate[i].name + ".csv");
    files.add(folder + "/" + written.back(), predictionCsv(r.validate[i], r.validate_after.predictions[i]));
  }
  addReport(files, folder, page, jsonWithUnits(r.units, identifyJson(r)), identifySeries(r));
  removeStale(folder, earlier, written);
  files.commit();
}

}  // namespace knee_robot::report
