#include "knee_robot/report/drive_gains_report.h"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <filesystem>

#include "json_parts.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::report {
namespace {

constexpr double kInterval = 1.96;  ///< standard errors of 95 %

const mechanism::Actuator& joint(const mechanism::Robot& robot, Eigen::Index i) {
  return robot.actuators[static_cast<std::size_t>(i)];
}

const char* keyOf(const mechanism::Actuator& a) {
  return a.revolute ? "torque_per_ampere_Nm" : "force_per_ampere_N";
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
    own[keyOf(joint(robot, i))] = exactNumber(gains.gain[i]);
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
    char line[160];
    std::snprintf(line, sizeof line, "  %-22s %8.3f  (%.3f to %.3f) %s/A   current explained to %.1f %%\n",
                  joint(robot, i).name.c_str(), g.gain[i], g.gain[i] - kInterval * g.std[i],
                  g.gain[i] + kInterval * g.std[i], joint(robot, i).revolute ? "N m" : "N", g.percent[i]);
    out += line;
  }
  out += "payload's centre in the last body's frame, m:";
  for (int k = 0; k < 3; ++k)
    out += std::string(k > 0 ? ", " : " ") + "xyz"[k] + " " + shortNumber(g.center_m[k], 3) + " +- " +
           shortNumber(g.center_std_m[k], 2);
  return out + "\n";
}

void writeDriveGains(const mechanism::Robot& robot, const identification::DriveGains& g, const std::string& folder) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < g.gain.size(); ++i) {
    list.push_back({{"joint", joint(robot, i).name},
                    {keyOf(joint(robot, i)), g.gain[i]},
                    {"std", g.std[i]},
                    {"low", g.gain[i] - kInterval * g.std[i]},
                    {"high", g.gain[i] + kInterval * g.std[i]},
                    {"rms_percent", g.percent[i]}});
  }
  const Json j = {{"command", "drive_gains"},
                  {"payload_kg", g.payload_kg},
                  {"level", 0.95},
                  {"drive_gains", list},
                  {"payload_center_m", jsonArray(g.center_m)},
                  {"payload_center_std_m", jsonArray(g.center_std_m)},
                  {"iterations", g.iterations}};
  makeFolder(folder);
  writeFileAtomically(folder + "/robot.yaml", robotText(robot, g));
  writeFileAtomically(folder + "/report.json", j.dump(2) + "\n");
}

}  // namespace knee_robot::report
