#pragma once

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot {

/// Constants of one body in the frame in which its leg (or the platform) computes.
struct BodyConstants {
  double mass = 0.0;
  Vector3 first_moment = Vector3::Zero();  ///< about the link frame's origin
  Matrix3 inertia = Matrix3::Zero();       ///< about the link frame's origin
};

/// Constant description of the rigid robot for inverse and forward dynamics: geometry, gravity, inertias.
struct RigidModel {
  RigidModel(const Mechanism& mechanism, const Vector3& gravity, const RobotInertia& inertia);

  Mechanism mechanism;
  Vector3 gravity;                             ///< m/s^2, base frame
  std::array<BodyConstants, kLegs> cylinders;  ///< leg basis (-t, u, n), origin in the base joint
  std::array<BodyConstants, kLegs> rods;       ///< leg basis (-t, u, n), origin in the platform joint
  std::array<Matrix3, kLegs> leg_inertias;     ///< cylinder + rod
  BodyConstants platform;                      ///< platform frame
  Vector4 rotor_mass;                          ///< kg, per actuator
};

}  // namespace knee_robot
