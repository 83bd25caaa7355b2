#include "knee_robot/report/drive_gains_report.h"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <filesystem>

#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"

namespace knee_robot::report {
namespace {

const mechanism::Actuator& joint(const mechanism::Robot& robot, Eigen::Index i) {
  return robot.actuators[static_cast<std::size_t>(i)];
}

/// The robot file with these gains; the URDF by its whole path, because the copy lies elsewhere.
std::string robotText(const mechanism::Robot& robot, const identification::DriveGains& gains) {
  YAML::Node file = YAML::Load(readFile(robot.path));
  file["urdf"] = std::filesystem::absolute(robot.urdf).lexically_normal().string();
  YAML::Node joints(YAML::NodeType::Sequence);
  for (const YAML::Node& entry : file["joints"]) {
    const std::string name = entry["name"].Scalar();
    bool moves = false;
    for (const mechanism::Actuator& a : robot.actuators)
      moves = moves || a.name == name;
    if (!moves) joints.push_back(entry);  // locked
  }
  for (Eigen::Index i = 0; i < gains.gain.size(); ++i) {
    YAML::Node own(YAML::NodeType::Map);
    for (const YAML::Node& entry : file["joints"]) {
      if (entry["name"].Scalar() == joint(robot, i).name) own = YAML::Clone(entry);
    }
    own["name"] = joint(robot, i).name;
    own[gainKey(joint(robot, i))] = exactNumber(gains.gain[i]);
    joints.push_back(own);
  }
  file["joints"] = joints;
  YAML::Emitter out;
  out << file;
  return std::string(out.c_str()) + "\n";
}

}  // namespace

std::string driveGainsSummary(const mechanism::Robot& robot, const identification::DriveGains& g) {
  std::string out = "drive gains by a payload of " + shortNumber(g.payload_kg) + " kg, with 95 % intervals\n";
  for (Eigen::Index i = 0; i < g.gain.size(); ++i) {
    char line[200];
    std::snprintf(line, sizeof line, "  %-22s %8.3f  (%.3f to %.3f) %s/A   error %.1f %% of the current's rms\n",
                  joint(robot, i).name.c_str(), g.gain[i], g.gain[i] - kGainInterval * g.std[i],
                  g.gain[i] + kGainInterval * g.std[i], joint(robot, i).revolute ? "N m" : "N", g.percent[i]);
    out += line;
  }
  for (const std::string& note : g.notes)
    out += "  " + note + "\n";
  out += "payload's centre in the last body's frame, m:";
  for (int k = 0; k < 3; ++k)
    out += std::string(k > 0 ? ", " : " ") + "xyz"[k] + " " + shortNumber(g.center_m[k], 3) + " +- " +
           shortNumber(g.center_std_m[k], 2);
  return out + "\n";
}

void writeDriveGains(const mechanism::Robot& robot, const identification::DriveGains& g,
                     const std::string& command_line, const std::string& folder) {
  const Page page("drive_gains");
  makeFolder(folder);
  FileSet files;
  files.add(folder + "/robot.yaml", robotText(robot, g));
  addReport(files, folder, page, driveGainsJson(robot, g, command_line), Json::object());
  files.commit();
}

}  // namespace knee_robot::report
