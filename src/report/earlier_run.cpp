#include "earlier_run.h"

#include <algorithm>
#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestReport = 64u << 20;

/// The report in the folder; null when there is none that can be read.
Json reportIn(const std::string& folder) {
  const std::string path = folder + "/report.json";
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  try {
    return Json::parse(readFile(path, kLargestReport), nullptr, false);
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

std::vector<std::string> filesOfEarlierRun(const std::string& folder, const std::string& command) {
  std::vector<std::string> names;
  const Json report = reportIn(folder);
  if (!report.is_object() || report.value("/command"_json_pointer, Json()) != command) return names;
  for (const Json& file : report.value("/data/validate"_json_pointer, Json::array())) {
    if (file.is_string()) names.push_back("prediction_" + fs::path(file.get<std::string>()).stem().string() + ".csv");
  }
  if (report.value("/physical/done"_json_pointer, Json()) == true)
    names.insert(names.end(), {"model_physical.yaml", "identified.urdf"});
  return names;
}

void removeStale(const std::string& folder, const std::vector<std::string>& earlier,
                 const std::vector<std::string>& written) {
  for (const std::string& name : earlier) {
    if (std::find(written.begin(), written.end(), name) != written.end()) continue;
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    if (fs::is_regular_file(fs::symlink_status(path, error))) fs::remove(path, error);
  }
}

}  // namespace knee_robot::report
