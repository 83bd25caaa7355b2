#include "trace_next_report.h"

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::report {
namespace {

using Json = nlohmann::ordered_json;

std::string sentence(const tracing::NextExperiment& n) {
  if (!n.planned) return "No next experiment: " + n.reason + ".";
  return "To tell " + n.first + " from " + n.second + ", play " + kNextExperimentFile +
         ": the angle between the two goes from " + shortNumber(kDegrees * n.now.angle_rad, 3) + " to " +
         shortNumber(kDegrees * n.then.angle_rad, 3) + " deg, and what the second cannot mimic of the first from " +
         shortNumber(n.now.visible_N, 2) + " to " + shortNumber(n.then.visible_N, 2) + " N rms.";
}

Json separationJson(const tracing::Separation& s) {
  return {{"angle_deg", kDegrees * s.angle_rad}, {"visible_N", s.visible_N}};
}

}  // namespace

nlohmann::ordered_json nextExperimentJson(const tracing::NextExperiment& n) {
  if (n.first.empty()) return {};
  Json j = {{"separates", {n.first, n.second}}, {"sentence", sentence(n)}};
  j["training"] = separationJson(n.now);
  if (!n.planned) {
    j["reference"] = Json();
    return j;
  }
  j["planned"] = separationJson(n.then);
  j["reference"] = kNextExperimentFile;
  j["seconds"] = n.reference.period_s * static_cast<double>(n.reference.points.rows() - 1);
  j["motions_looked_at"] = n.motions;
  j["margins"] = Json::array();
  for (const trajectory::Margin& m : n.check.margins)
    j["margins"].push_back({{"quantity", trajectory::nameOf(m.quantity)}, {"left", m.left}});
  return j;
}

std::string nextExperimentSummary(const tracing::NextExperiment& n) {
  return n.first.empty() ? std::string() : sentence(n) + "\n";
}

void addNextExperiment(FileSet& files, const tracing::NextExperiment& n, const std::string& robot_path,
                       const std::string& folder) {
  if (!n.planned) return;
  files.add(folder + "/" + kNextExperimentFile,
            trajectory::formatReference(
                n.reference, {"planned by trace for " + robot_path, "separates " + n.first + " from " + n.second}));
}

}  // namespace knee_robot::report
