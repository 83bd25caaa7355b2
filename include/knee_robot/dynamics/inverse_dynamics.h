#pragma once

#include "knee_robot/dynamics/rigid_model.h"

namespace knee_robot::dynamics {

/// Generalized force on the pose coordinates (N, N, N m, N m) that makes the rigid links, without rotors, move as
/// `motion` says: M_links(x) xdd + h(x, xd). Gravity included, friction not. Real-time safe.
mechanism::Vector4 poseForces(const RigidModel& model, const mechanism::RobotMotion& motion);

/// Actuator forces (N) that produce `motion`: J^-T poseForces + rotor mass * length acceleration. False when J is
/// singular to working precision (the forces are then not touched). Real-time safe.
bool inverseDynamics(const RigidModel& model, const mechanism::Motion& motion, mechanism::Vector4& actuator_forces);

/// Forces (N, base frame) with which the platform acts on the tips of legs 1 to 3 through their spherical joints (the
/// cut joints of the opened robot), while the actuators exert `actuator_forces` (N; friction counted in) along
/// `motion`: an independent check, since another engine says them, too (SimbodyRobot::ballForces). Real-time safe.
std::array<mechanism::Vector3, 3> sphericalJointForces(const RigidModel& model, const mechanism::RobotMotion& motion,
                                                       const mechanism::Vector4& actuator_forces);

}  // namespace knee_robot::dynamics
