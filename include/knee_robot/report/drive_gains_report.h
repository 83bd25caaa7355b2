#pragma once

#include <string>

#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::report {

/// What the program prints: gain and 95 % interval of every joint, the payload's centre.
std::string driveGainsSummary(const mechanism::Robot& robot, const identification::DriveGains& gains);
/// report.json, and the robot file once more with torque_per_ampere_Nm in every joint.
void writeDriveGains(const mechanism::Robot& robot, const identification::DriveGains& gains, const std::string& folder);

}  // namespace knee_robot::report
