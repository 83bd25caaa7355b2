#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::identification {

/// Recordings as they are in their files.
std::vector<recording::Recording> readRecordings(const std::vector<std::string>& files);

/// What a chain's robot file leaves open and these recordings (as read) tell: joints that stand still in all of them,
/// where others move, are locked where they stand, so that `robot` becomes the shorter chain (the first recording's
/// notes say so); encoders' steps. Other robots stay as they are.
void adaptToRecordings(mechanism::Robot& robot, std::vector<recording::Recording>& recordings);

/// Takes the encoders' steps of a robot that is no chain from its recordings (as read), where all small changes of a
/// position are multiples of one that is not the robot file's; the first recording's notes say so. How finely friction
/// near rest can be told depends on them.
void takeRecordedSteps(mechanism::Robot& robot, std::vector<recording::Recording>& recordings);

/// Reads recordings of this robot and brings them to metres and newtons of its actuators (mechanism::kJointRadius_m). A
/// chain of whose joints nothing but the current was recorded counts as recorded in amperes from here on, whatever its
/// robot file left open.
/// InputError, by column, where a recording's columns are not the robot's.
std::vector<recording::Recording> loadRecordings(mechanism::Robot& robot, const std::vector<std::string>& files);

/// The second half of it, for a recording that is there already. A revolute joint that was recorded within one turn, as
/// encoders of continuous joints do, is followed over the jumps.
void toActuatorUnits(mechanism::Robot& robot, recording::Recording& recording);

/// Drive gains that a model file knows and the robot file leaves open.
void takeGains(const dynamics::Model& model, mechanism::Robot& robot);

}  // namespace knee_robot::identification
