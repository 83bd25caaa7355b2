#include "knee_robot/report/report_folder.h"

#include <filesystem>
#include <map>

#include "earlier_run.h"
#include "knee_robot/base/output_paths.h"
#include "trace_next_report.h"

namespace knee_robot::report {
namespace {

namespace fs = std::filesystem;

/// Beside report.json and report.html.
const std::map<std::string, std::vector<std::string>>& ownFiles() {
  static const std::map<std::string, std::vector<std::string>> kOwn = {
      {"identify", {"model.yaml", "model_physical.yaml", "identified.urdf"}},
      {"trace", {"model.yaml", kNextExperimentFile}},
      {"predict", {}},
      {"compare", {"actuators.svg", "pose.svg"}},
      {"drive_gains", {"robot.yaml"}},
      {"tune_pid", {"gains.yaml"}}};
  return kOwn;
}

std::vector<std::string> writtenBy(const ReportPlan& plan) {
  std::vector<std::string> names = ownFiles().at(plan.command);
  names.insert(names.end(), {"report.json", "report.html"});
  for (const std::string& recording : plan.predicted)
    names.push_back("prediction_" + fs::path(recording).stem().string() + ".csv");
  const std::vector<std::string> earlier = filesOfEarlierRun(plan.folder, plan.command);
  names.insert(names.end(), earlier.begin(), earlier.end());
  for (std::string& name : names)
    name = (fs::path(plan.folder) / name).string();
  return names;
}

}  // namespace

void requireReportFolder(const ReportPlan& plan) {
  requireWritableFolder(plan.folder);
  const std::vector<std::string> written = writtenBy(plan);
  requireNoneOverwritten(plan.read, written);
  requireNoneOverwritten(plan.predicted, written);
}

}  // namespace knee_robot::report
