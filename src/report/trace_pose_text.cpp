#include <cstdio>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "trace_pose_report.h"

namespace knee_robot::report {
namespace {

using Json = nlohmann::ordered_json;

Json errorsJson(const tracing::PoseErrors& e) {
  return {{"rms_m", {e.rms[0], e.rms[1]}},
          {"rms_rad", {e.rms[2], e.rms[3]}},
          {"max_m", {e.max[0], e.max[1]}},
          {"max_rad", {e.max[2], e.max[3]}},
          {"rows", e.rows}};
}

Json recordingsJson(const std::vector<tracing::PoseRecording>& recordings,
                    tracing::PoseErrors tracing::PoseRecording::*errors) {
  Json list = Json::array();
  for (const tracing::PoseRecording& r : recordings) {
    Json j = errorsJson(r.*errors);
    j["recording"] = r.path;
    list.push_back(j);
  }
  return list;
}

Json errorsJson(const tracing::PoseTrace& pose, tracing::PoseErrors tracing::PoseRecording::*errors) {
  const tracing::PoseRecording& shown = pose.validate.empty() ? pose.train.front() : pose.validate.front();
  Json j = errorsJson(shown.*errors);
  j["of"] = pose.validate.empty() ? "train" : "validate";
  j["train"] = recordingsJson(pose.train, errors);
  j["validate"] = recordingsJson(pose.validate, errors);
  return j;
}

Json findingJson(const tracing::PoseFinding& f) {
  Json j = {{"name", tracing::nameOf(f.hypothesis.cause)},
            {"place", tracing::textOf(f.hypothesis)},
            {"parameters", {{tracing::parameterOf(f.hypothesis), {{"value", f.value}, {"std", f.std}}}}},
            {"explained_rms_m", {f.explained[0], f.explained[1]}},
            {"explained_rms_rad", {f.explained[2], f.explained[3]}},
            {"share", f.share},
            {"null_share", f.null_share},
            {"p", f.p},
            {"transfers", f.transfers},
            {"held_back_gain", {{"share", f.gain}, {"standard_error", f.gain_error}}}};
  Json names = Json::array(), places = Json::array();
  for (const tracing::PoseHypothesis& h : f.confusable) {
    places.push_back(tracing::textOf(h));
    const std::string name = tracing::nameOf(h.cause);
    if (name != tracing::nameOf(f.hypothesis.cause) && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  j["indistinguishable_from"] = names;
  j["not_told_from"] = places;
  return j;
}

Json frameJson(const tracing::CameraAlignment& a) {
  return {{"delay_s", a.delay_s},
          {"rotation_rad", a.rotation_rad},
          {"shift_x_m", a.shift_x_m},
          {"shift_z_m", a.shift_z_m},
          {"plate_rad", a.plate_rad}};
}

std::string valueText(const tracing::PoseFinding& f) {
  const std::string name = tracing::parameterOf(f.hypothesis);
  const bool angle = name.find("_rad") != std::string::npos;
  const double factor = angle ? kDegrees : 1e3;
  return shortNumber(factor * f.value, 3) + " +- " + shortNumber(factor * f.std, 2) + (angle ? " deg" : " mm");
}

std::string line(const std::string& name, const tracing::PoseErrors& e) {
  char text[160];
  std::snprintf(text, sizeof text, "  %-34s%9.2f%9.2f%9.2f%9.2f\n", name.c_str(), 1e3 * e.rms[0], 1e3 * e.rms[1],
                kDegrees * e.rms[2], kDegrees * e.rms[3]);
  return text;
}

}  // namespace

nlohmann::ordered_json tracePoseJson(const tracing::PoseTrace& pose) {
  if (!pose.available) return {};
  Json j = {{"before", errorsJson(pose, &tracing::PoseRecording::before)},
            {"after", errorsJson(pose, &tracing::PoseRecording::after)}};
  j["after_with_own_frame"] = errorsJson(pose, &tracing::PoseRecording::refitted);
  j["frame_before"] = frameJson(pose.before);
  j["frame_after"] = frameJson(pose.model.frame);
  j["findings"] = Json::array();
  for (const tracing::PoseFinding& f : pose.findings)
    j["findings"].push_back(findingJson(f));
  j["picture_noise"] = {{"m", {pose.noise[0], pose.noise[1]}}, {"rad", {pose.noise[2], pose.noise[3]}}};
  j["condition_max"] = pose.condition_max;
  j["absorbed"] = pose.absorbed;
  j["not_added"] = pose.rejected;
  j["notes"] = pose.notes;
  return j;
}

std::string tracePoseSummary(const tracing::PoseTrace& pose) {
  if (!pose.available) return {};
  std::string out = "\npose, camera minus encoders, rms         X, mm    Z, mm  theta deg psi deg\n";
  for (const auto& [kind, recordings] :
       {std::pair{"training ", &pose.train}, std::pair{"validation ", &pose.validate}}) {
    for (const tracing::PoseRecording& r : *recordings) {
      out += std::string(kind) + r.name + "\n" + line("before", r.before) + line("after", r.after);
      out += line("after, camera's frame refitted", r.refitted);
    }
  }
  if (pose.findings.empty()) out += "No explanation of the pose beats surrogates; nothing was added to it.\n";
  for (const tracing::PoseFinding& f : pose.findings) {
    out += "  " + tracing::textOf(f.hypothesis) + ": " + valueText(f) + "; explains " +
           shortNumber(100.0 * f.share, 3) + " % of the weighed square, surrogates at most " +
           shortNumber(100.0 * f.null_share, 2) + " %, p = " + shortNumber(f.p, 2);
    for (std::size_t k = 0; k < f.confusable.size(); ++k)
      out += (k ? ", " : "; not told from ") + tracing::textOf(f.confusable[k]);
    out += f.transfers ? "\n" : "; does not transfer: home is set anew at every start\n";
  }
  for (const std::string& note : pose.notes)
    out += note + "\n";
  return out;
}

}  // namespace knee_robot::report
