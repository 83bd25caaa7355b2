#pragma once

#include <string>

#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/simulation/plant.h"

namespace knee_robot::simulation {

inline mechanism::Robot configuredRobot(const std::string& name) {
  return mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + name + ".yaml");
}

/// The configured robot with rotors of 5.6 kg and stops far away.
inline PlantModel plantOf(const std::string& name, double rotor_mass_kg = 5.6) {
  const mechanism::Robot robot = configuredRobot(name);
  dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  inertia.rotor_mass.setConstant(rotor_mass_kg);
  return PlantModel(dynamics::RigidModel(*robot.mechanism, robot.gravity, inertia), mechanism::Lengths::Constant(0.01),
                    mechanism::Lengths::Constant(10.0));
}

/// Actuator forces (N) that hold the robot at rest.
inline mechanism::Vector4 holdingForces(const PlantModel& model, const mechanism::Pose& pose) {
  mechanism::Motion motion;
  motion.pose = pose;
  mechanism::Vector4 forces = mechanism::Vector4::Zero();
  if (!dynamics::inverseDynamics(model.rigid, motion, forces)) throw std::runtime_error("singular pose");
  return forces;
}

}  // namespace knee_robot::simulation
