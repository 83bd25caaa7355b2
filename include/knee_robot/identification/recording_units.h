#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::identification {

/// Reads recordings of this robot and brings them to metres and newtons of its actuators (mechanism::kJointRadius_m). A chain of
/// whose joints nothing but the current was recorded counts as recorded in amperes from here on, whatever its robot file left open.
/// InputError, by column, where a recording's columns are not the robot's.
std::vector<recording::Recording> loadRecordings(mechanism::Robot& robot, const std::vector<std::string>& files);

/// The second half of it, for a recording that is there already.
void toActuatorUnits(mechanism::Robot& robot, recording::Recording& recording);

/// Drive gains that a model file knows and the robot file leaves open.
void takeGains(const dynamics::Model& model, mechanism::Robot& robot);

}  // namespace knee_robot::identification
