#pragma once

#include <array>

#include "knee_robot/dynamics/rigid_body.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::dynamics {

/// Inertia of the nine links, each in its frame of parameters.h, and what the drives add.
struct RobotInertia {
  std::array<LinkInertia, kLinks> links;
  /// Motor and screw inertia reflected to each actuator (kg); the paper leaves it out. A URDF knows none: zero after
  /// loading.
  mechanism::Vector4 rotor_mass = mechanism::Vector4::Zero();
};

/// Reads the link inertias from the robot's URDF (urdfdom; the inertial origin's xyz and rpy are respected). InputError
/// that names the URDF and the link when the robot has no URDF, a link is missing, a link's inertia is physically
/// impossible, or the URDF's joint axes, base or platform joints differ from the robot file's geometry by more than
/// 1e-6 m (the robot file wins).
RobotInertia loadRobotInertia(const mechanism::Robot& robot);

/// The 90 rigid parameters.
InertialParameters toParameters(const RobotInertia& inertia);

}  // namespace knee_robot::dynamics
