#include "knee_robot/dynamics/forward_dynamics.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "knee_robot/dynamics/inverse_dynamics.h"

namespace knee_robot::dynamics {
namespace {

/// Inertia of a leg against (q1, q2, q3), from the velocities per unit rate: turning axes (c2, -s2, 0) and z, travel of
/// the rod's origin (0, 0, length c2), (-length, 0, 0) and (0, 1, 0) in the leg basis.
mechanism::Matrix3 legMass(const mechanism::LegMotion& leg, const BodyConstants& rod,
                           const mechanism::Matrix3& inertia) {
  const double c2 = leg.cos_q2, s2 = leg.sin_q2, length = leg.length;
  const mechanism::Vector3& h = rod.first_moment;
  const mechanism::Vector3 axis1(c2, -s2, 0.0);
  const mechanism::Vector3 momentum1 = inertia * axis1;
  const mechanism::Vector3 sway1(-s2 * h.z(), -c2 * h.z(), c2 * h.y() + s2 * h.x());  // axis1 x h
  const mechanism::Vector3 sway2(-h.y(), h.x(), 0.0);                                 // z x h
  const double reach1 = length * c2;
  mechanism::Matrix3 mass;
  mass(0, 0) = axis1.dot(momentum1) + rod.mass * reach1 * reach1 + 2.0 * reach1 * sway1.z();
  mass(1, 1) = inertia(2, 2) + rod.mass * length * length - 2.0 * length * sway2.x();
  mass(2, 2) = rod.mass;
  mass(0, 1) = mass(1, 0) = momentum1.z() - length * sway1.x();
  mass(0, 2) = mass(2, 0) = sway1.y();
  mass(1, 2) = mass(2, 1) = sway2.y();
  return mass;
}

void addPlatformMass(const mechanism::PlatformMotion& platform, const BodyConstants& body, mechanism::Matrix4& mass) {
  const mechanism::Matrix3& rotation = platform.rotation;
  const mechanism::Vector3 x = rotation.row(0), y = rotation.row(1),
                           z = rotation.row(2);  // base axes in the platform's frame
  const mechanism::Vector3 turn_theta = y.cross(body.first_moment),
                           turn_psi = mechanism::Vector3::UnitZ().cross(body.first_moment);
  const mechanism::Vector3 momentum = body.inertia * y;
  mass(0, 0) += body.mass;
  mass(1, 1) += body.mass;
  mass(2, 2) += y.dot(momentum);
  mass(3, 3) += body.inertia(2, 2);
  const auto add = [&mass](int row, int column, double value) {
    mass(row, column) += value;
    mass(column, row) += value;
  };
  add(2, 3, momentum.z());
  add(0, 2, x.dot(turn_theta));
  add(0, 3, x.dot(turn_psi));
  add(1, 2, z.dot(turn_theta));
  add(1, 3, z.dot(turn_psi));
}

void fillMass(const RigidModel& model, const mechanism::RobotMotion& motion, mechanism::Matrix4& mass) {
  mass.noalias() = motion.jacobian.transpose() * model.rotor_mass.asDiagonal() * motion.jacobian;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::LegMotion& leg = motion.legs[i];
    const mechanism::Matrix34 momentum = legMass(leg, model.rods[i], model.leg_inertias[i]) * leg.joints_per_pose;
    mass.noalias() += leg.joints_per_pose.transpose() * momentum;
  }
  addPlatformMass(motion.platform, model.platform, mass);
}

}  // namespace

void equationsOfMotion(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity,
                       ForwardDynamicsData& data) {
  mechanism::robotMotion(model.mechanism, {pose, pose_velocity, mechanism::Vector4::Zero()}, data.motion);
  data.jacobian = data.motion.jacobian;
  fillMass(model, data.motion, data.mass);
  data.bias = poseForces(model, data.motion);
  data.bias.noalias() += data.jacobian.transpose() * model.rotor_mass.cwiseProduct(data.motion.lengthAcceleration());
}

bool forwardDynamics(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity,
                     const mechanism::Vector4& actuator_forces, ForwardDynamicsData& data,
                     const mechanism::Vector4& pose_forces) {
  equationsOfMotion(model, pose, pose_velocity, data);
  const Eigen::LLT<mechanism::Matrix4> factor(data.mass);
  if (factor.info() != Eigen::Success) return false;
  data.acceleration = factor.solve(data.jacobian.transpose() * actuator_forces + pose_forces - data.bias);
  return true;
}

double kineticEnergy(const RigidModel& model, const mechanism::Pose& pose, const mechanism::Vector4& pose_velocity) {
  mechanism::RobotMotion motion;
  mechanism::robotMotion(model.mechanism, {pose, pose_velocity, mechanism::Vector4::Zero()}, motion);
  mechanism::Matrix4 mass;
  fillMass(model, motion, mass);
  return 0.5 * pose_velocity.dot(mass * pose_velocity);
}

double potentialEnergy(const RigidModel& model, const mechanism::Pose& pose) {
  mechanism::RobotMotion motion;
  mechanism::robotMotion(model.mechanism, {pose, mechanism::Vector4::Zero(), mechanism::Vector4::Zero()}, motion);
  mechanism::Vector3 moment =
      model.platform.mass * mechanism::Vector3(pose[0], 0.0, pose[1]);  // sum of mass times position
  moment += motion.platform.rotation * model.platform.first_moment;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::LegMotion& leg = motion.legs[i];
    const mechanism::Vector3 inner = model.cylinders[i].first_moment + model.rods[i].first_moment;
    moment += -leg.t * inner.x() + leg.u * inner.y() + leg.n * inner.z();
    moment += (model.cylinders[i].mass + model.rods[i].mass) * model.mechanism.base_points[i];
    moment += model.rods[i].mass * leg.length * leg.u;
  }
  return -model.gravity.dot(moment);
}

}  // namespace knee_robot::dynamics
