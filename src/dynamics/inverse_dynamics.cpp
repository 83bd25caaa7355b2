#include "knee_robot/dynamics/inverse_dynamics.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace knee_robot::dynamics {
namespace {

/// Newton and Euler for the two bodies of a leg, in its basis (-t, u, n): forces on (q1, q2, q3). Tip accelerations
/// less gravity.
mechanism::Vector3 legForces(const mechanism::LegMotion& leg, const mechanism::Vector3& gravity,
                             const BodyConstants& cylinder, const BodyConstants& rod,
                             const mechanism::Matrix3& inertia) {
  const double c2 = leg.cos_q2, s2 = leg.sin_q2, length = leg.length;
  const mechanism::Vector3 &v = leg.rate, &e = leg.acceleration;
  const mechanism::Vector3 omega(c2 * v[0], -s2 * v[0], v[1]);
  const mechanism::Vector3 alpha(c2 * e[0] - s2 * v[0] * v[1], -s2 * e[0] - c2 * v[0] * v[1], e[1]);
  const mechanism::Vector3 rise(leg.t.dot(gravity), -leg.u.dot(gravity), -leg.n.dot(gravity));
  const mechanism::Vector3& tip = leg.tip_acceleration;
  const mechanism::Vector3 a = mechanism::Vector3(-leg.t.dot(tip), leg.u.dot(tip), leg.n.dot(tip)) + rise;

  const mechanism::Vector3 force =
      rod.mass * a + alpha.cross(rod.first_moment) + omega.cross(omega.cross(rod.first_moment));
  const mechanism::Vector3 moment =
      inertia * alpha + omega.cross(inertia * omega) + cylinder.first_moment.cross(rise) + rod.first_moment.cross(a);
  return {c2 * (moment.x() + length * force.z()) - s2 * moment.y(), moment.z() - length * force.x(), force.y()};
}

mechanism::Vector4 platformForces(const mechanism::PlatformMotion& platform, const mechanism::Vector3& gravity,
                                  const BodyConstants& body) {
  const mechanism::Matrix3& rotation = platform.rotation;
  const mechanism::Vector3 a = rotation.transpose() * (platform.acceleration - gravity);
  const mechanism::Vector3 omega = rotation.transpose() * platform.omega, alpha = rotation.transpose() * platform.alpha;
  const mechanism::Vector3 force =
      body.mass * a + alpha.cross(body.first_moment) + omega.cross(omega.cross(body.first_moment));
  const mechanism::Vector3 moment =
      body.inertia * alpha + omega.cross(body.inertia * omega) + body.first_moment.cross(a);
  return {rotation.row(0).dot(force), rotation.row(2).dot(force), rotation.row(1).dot(moment), moment.z()};
}

}  // namespace

mechanism::Vector4 poseForces(const RigidModel& model, const mechanism::RobotMotion& motion) {
  mechanism::Vector4 forces = platformForces(motion.platform, model.gravity, model.platform);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Vector3 joint =
        legForces(motion.legs[i], model.gravity, model.cylinders[i], model.rods[i], model.leg_inertias[i]);
    forces.noalias() += motion.legs[i].joints_per_pose.transpose() * joint;
  }
  return forces;
}

bool inverseDynamics(const RigidModel& model, const mechanism::Motion& motion, mechanism::Vector4& actuator_forces) {
  mechanism::RobotMotion all;
  mechanism::robotMotion(model.mechanism, motion, all);
  mechanism::Matrix4 inverse;
  bool invertible = false;
  all.jacobian.computeInverseWithCheck(inverse, invertible, 1e-14);
  if (!invertible) return false;
  actuator_forces =
      inverse.transpose() * poseForces(model, all) + model.rotor_mass.cwiseProduct(all.lengthAcceleration());
  return true;
}

std::array<mechanism::Vector3, 3> sphericalJointForces(const RigidModel& model, const mechanism::RobotMotion& motion,
                                                       const mechanism::Vector4& actuator_forces) {
  std::array<mechanism::Vector3, 3> forces;
  for (int i = 0; i < 3; ++i) {
    const mechanism::LegMotion& leg = motion.legs[i];
    const mechanism::Vector3 joint =
        legForces(leg, model.gravity, model.cylinders[i], model.rods[i], model.leg_inertias[i]);
    // The universal joint passes no torque: what turns the leg is the tip force across it, and what the actuator does
    // not carry along it.
    const double across_n = joint[0] / (leg.length * leg.cos_q2), across_t = joint[1] / leg.length;
    const double along = joint[2] + model.rotor_mass[i] * leg.acceleration[2] - actuator_forces[i];
    forces[i] = across_n * leg.n + across_t * leg.t + along * leg.u;
  }
  return forces;
}

}  // namespace knee_robot::dynamics
