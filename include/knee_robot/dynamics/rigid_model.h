#pragma once

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::dynamics {

/// Constants of one body in the frame in which its leg (or the platform) computes.
struct BodyConstants {
  double mass = 0.0;
  mechanism::Vector3 first_moment = mechanism::Vector3::Zero();  ///< about the link frame's origin
  mechanism::Matrix3 inertia = mechanism::Matrix3::Zero();       ///< about the link frame's origin
};

/// Constant description of the rigid robot for inverse and forward dynamics: geometry, gravity, inertias.
struct RigidModel {
  RigidModel(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity, const RobotInertia& inertia);
  /// Links by their inertial parameters (parameters.h), whether or not a body could have them; without rotors.
  RigidModel(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
             const InertialParameters& parameters);

  mechanism::Mechanism mechanism;
  mechanism::Vector3 gravity;                             ///< m/s^2, base frame
  std::array<BodyConstants, mechanism::kLegs> cylinders;  ///< leg basis (-t, u, n), origin in the base joint
  std::array<BodyConstants, mechanism::kLegs> rods;       ///< leg basis (-t, u, n), origin in the platform joint
  std::array<mechanism::Matrix3, mechanism::kLegs> leg_inertias;  ///< cylinder + rod
  BodyConstants platform;                                         ///< platform frame
  mechanism::Vector4 rotor_mass;                                  ///< kg, per actuator
};

}  // namespace knee_robot::dynamics
