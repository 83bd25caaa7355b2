#pragma once

#include <string>

#include "knee_robot/trajectory/exercise_fit.h"
#include "test/trajectory/robots.h"

namespace knee_robot::excitation {

/// Where planExcitation starts from.
inline mechanism::Pose centreOf(const mechanism::Robot& robot) {
  return trajectory::startThatFitsMost({"excitation", "", false, 0.0, {}, std::nullopt}, robot, 0.0);
}

/// config/robots/NAME.yaml held to a condition of 60, 0.1 m/s and 1 m/s2: limits that bind.
inline mechanism::Robot moderateRobot(const std::string& name) {
  mechanism::Robot robot = trajectory::configuredRobot(name);
  robot.singularity_condition_max = 60.0;
  for (mechanism::Actuator& actuator : robot.actuators) {
    actuator.velocity_max_m_per_s = 0.1;
    actuator.acceleration_max_m_per_s2 = 1.0;
  }
  return robot;
}

}  // namespace knee_robot::excitation
