#pragma once

#include <string>

#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/simulation/plant.h"

namespace knee_robot {

inline Robot configuredRobot(const std::string& name) {
  return loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + name + ".yaml");
}

/// The configured robot with rotors of 5.6 kg and stops far away.
inline PlantModel plantOf(const std::string& name, double rotor_mass_kg = 5.6) {
  const Robot robot = configuredRobot(name);
  RobotInertia inertia = loadRobotInertia(robot);
  inertia.rotor_mass.setConstant(rotor_mass_kg);
  return PlantModel(RigidModel(*robot.mechanism, robot.gravity, inertia), Lengths::Constant(0.01),
                    Lengths::Constant(10.0));
}

/// Actuator forces (N) that hold the robot at rest.
inline Vector4 holdingForces(const PlantModel& model, const Pose& pose) {
  Motion motion;
  motion.pose = pose;
  Vector4 forces = Vector4::Zero();
  if (!inverseDynamics(model.rigid, motion, forces)) throw std::runtime_error("singular pose");
  return forces;
}

}  // namespace knee_robot
