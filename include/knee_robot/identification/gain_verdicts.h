#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::identification {

/// Friction, rotor and offset of a joint whose drive's gain was estimated are no better known than that gain: corrects
/// their verdicts in a model of the robot.
void judgeByGains(const mechanism::Robot& robot, dynamics::Model& model);

/// The estimated gains with their intervals, and what they rest on, one sentence each; empty where none was estimated.
std::vector<std::string> aboutGains(const mechanism::Robot& robot);

}  // namespace knee_robot::identification
