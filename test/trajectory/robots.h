#pragma once

#include <gtest/gtest.h>

#include <string>

#include "knee_robot/base/constants.h"
#include "knee_robot/mechanism/robot.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::trajectory {

using mechanism::configuredRobot;

/// A robot of the paper's final geometry with limits that tests can rely on: lengths 0.5 to 1.0 m, 0.3 m/s, 5 m/s^2,
/// joints 90 deg, condition 1000; home 0.65, 0.66, 0.66, 0.61 m.
inline mechanism::Robot testRobot() {
  mechanism::Geometry geometry;
  geometry.R = {0.4, 0.4, 0.4};
  geometry.ds = 0.15;
  geometry.beta_FD = 90.0 * kDegree;
  geometry.beta_FI = 45.0 * kDegree;
  geometry.Rm = {0.3, 0.3, 0.3};
  geometry.beta_MD = 50.0 * kDegree;
  geometry.beta_MI = 90.0 * kDegree;
  mechanism::Robot robot;
  robot.path = "robot.yaml";
  robot.mechanism.emplace(geometry);
  mechanism::Actuator actuator;
  actuator.position_min_m = 0.5;
  actuator.position_max_m = 1.0;
  actuator.velocity_max_m_per_s = 0.3;
  actuator.acceleration_max_m_per_s2 = 5.0;
  for (const double home : {0.65, 0.66, 0.66, 0.61}) {
    actuator.home_length_m = home;
    robot.actuators.push_back(actuator);
  }
  robot.joints = {90.0 * kDegree, 90.0 * kDegree, 90.0 * kDegree};
  robot.singularity_condition_max = 1000.0;
  return robot;
}

/// `axes` separate actuators from -0.005 to 0.3 m.
inline mechanism::Robot testBench(int axes) {
  mechanism::Robot robot;
  robot.path = "bench.yaml";
  robot.kind = mechanism::MechanismKind::Axes;
  mechanism::Actuator actuator;
  actuator.position_min_m = -0.005;
  actuator.position_max_m = 0.3;
  actuator.velocity_max_m_per_s = 0.3;
  actuator.acceleration_max_m_per_s2 = 5.0;
  robot.actuators.assign(static_cast<std::size_t>(axes), actuator);
  return robot;
}

}  // namespace knee_robot::trajectory
