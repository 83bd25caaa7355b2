#pragma once

#include <string>

#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::report {

using identification::kGainInterval;

/// The robot file's key for a joint's gain.
inline const char* gainKey(const mechanism::Actuator& joint) {
  return joint.revolute ? "torque_per_ampere_Nm" : "force_per_ampere_N";
}

/// What the program prints: gain and 95 % interval of every joint, what is doubtful about them, the payload's centre.
std::string driveGainsSummary(const mechanism::Robot& robot, const identification::DriveGains& gains);
/// report.json: gain and 95 % interval of every joint, the payload's centre.
std::string driveGainsJson(const mechanism::Robot& robot, const identification::DriveGains& gains,
                           const std::string& command_line);
/// report.json and report.html, and the robot file once more with torque_per_ampere_Nm in every joint.
void writeDriveGains(const mechanism::Robot& robot, const identification::DriveGains& gains,
                     const std::string& command_line, const std::string& folder);

}  // namespace knee_robot::report
