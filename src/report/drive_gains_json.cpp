#include "knee_robot/report/drive_gains_report.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {

std::string driveGainsJson(const mechanism::Robot& robot, const identification::DriveGains& g,
                           const std::string& command_line) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < g.gain.size(); ++i) {
    const mechanism::Actuator& joint = robot.actuators[static_cast<std::size_t>(i)];
    list.push_back({{"joint", joint.name},
                    {gainKey(joint), g.gain[i]},
                    {"std", g.std[i]},
                    {"low", g.gain[i] - kGainInterval * g.std[i]},
                    {"high", g.gain[i] + kGainInterval * g.std[i]},
                    {"rms_percent", g.percent[i]}});
  }
  const Json j = {{"command", "drive_gains"},
                  {"robot", robot.path},
                  {"payload_kg", g.payload_kg},
                  {"level", 0.95},
                  {"drive_gains", list},
                  {"payload_center_m", jsonArray(g.center_m)},
                  {"payload_center_std_m", jsonArray(g.center_std_m)},
                  {"iterations", g.iterations},
                  {"notes", g.notes},
                  {"reproduce", command_line}};
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace knee_robot::report
