#pragma once

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::mechanism {

/// What a robot file with `mechanism: chain` says beside its URDF, whose path is in `robot`. InputError as loadRobot.
void readChainRobot(StrictMap& file, Robot& robot);

}  // namespace knee_robot::mechanism
