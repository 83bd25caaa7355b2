#pragma once

#include "knee_robot/dynamics/rigid_model.h"

namespace knee_robot::dynamics {

/// Equations of motion in pose coordinates, M xdd + h = J^T tau, rotors included (J = dq/dx = lengthJacobian).
struct ForwardDynamicsData {
  mechanism::RobotMotion motion;                         ///< at zero pose acceleration
  mechanism::Matrix4 mass = mechanism::Matrix4::Zero();  ///< M(x): kg, kg m, kg m^2
  mechanism::Vector4 bias =
      mechanism::Vector4::Zero();  ///< h(x, xd): velocity and gravity forces, friction not included
  mechanism::Matrix4 jacobian = mechanism::Matrix4::Zero();      ///< J
  mechanism::Vector4 acceleration = mechanism::Vector4::Zero();  ///< xdd, by forwardDynamics only
};

/// Fills mass, bias, jacobian (and motion). Real-time safe.
void equationsOfMotion(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity,
                       ForwardDynamicsData& data);

/// Fills all of data: pose acceleration caused by actuator forces (N). Friction is the caller's: subtract it from the
/// actuator forces, or pass its generalized force on the pose coordinates as `pose_forces`. M is positive definite
/// wherever the links have mass, also at singular poses: free motion is always defined. False when M is not (massless
/// robot). Real-time safe.
bool forwardDynamics(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity,
                     const mechanism::Vector4& actuator_forces, ForwardDynamicsData& data,
                     const mechanism::Vector4& pose_forces = mechanism::Vector4::Zero());

/// Kinetic energy of links and rotors (J). Real-time safe.
double kineticEnergy(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity);
/// Potential energy of the links in the gravity field (J), zero with all centres of mass in the base frame's origin.
/// Real-time safe.
double potentialEnergy(const RigidModel& model, const mechanism::Pose& pose);

}  // namespace knee_robot::dynamics
