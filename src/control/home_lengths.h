#pragma once

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// Of the legs at home, m, by the robot file.
inline mechanism::Lengths homeLengths(const mechanism::Robot& robot) {
  mechanism::Lengths home;
  for (Eigen::Index i = 0; i < home.size(); ++i)
    home[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m;
  return home;
}

}  // namespace knee_robot::control
