#include "knee_robot/simulation/plant.h"

#include <Eigen/Cholesky>
#include <limits>

namespace knee_robot::simulation {
namespace {

/// Bounds of the friction impulses during h seconds; an axis beyond its stop is pushed back as hard as it takes.
ImpulseBox impulseBox(const PlantModel& model, const PlantLoads& loads, const mechanism::Lengths& lengths, double h) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  ImpulseBox box;
  // Friction never drives, however asymmetric.
  box.high = (loads.coulomb - loads.coulomb_asymmetry).cwiseMax(0.0) * h;
  box.low = -(loads.coulomb + loads.coulomb_asymmetry).cwiseMax(0.0) * h;
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    if (lengths[axis] <= model.shortest_m[axis]) box.high[axis] = kUnlimited;
    if (lengths[axis] >= model.longest_m[axis]) box.low[axis] = -kUnlimited;
  }
  return box;
}

bool allHeld(const AxisContacts& contacts) {
  for (const AxisContact contact : contacts) {
    if (contact != AxisContact::Held) return false;
  }
  return true;
}

}  // namespace

/// M (v+ - v) = h (J^T (tau - C (w + w+) / 2) - bias + f) + Je^T p with w = J v; everything at the middle of the
/// substep but Je, the Jacobian at its end.
bool substepPlant(const PlantModel& model, const PlantLoads& loads, double h, PlantState& state, PlantData& data) {
  const mechanism::Pose middle = state.pose + 0.5 * h * state.pose_velocity;
  const mechanism::Vector4 predicted_velocity = state.pose_velocity + 0.5 * h * state.last_acceleration;
  dynamics::ForwardDynamicsData& dynamics = data.dynamics;
  dynamics::equationsOfMotion(model.rigid, middle, predicted_velocity, dynamics);
  const mechanism::Matrix4& jacobian = dynamics.jacobian;
  const mechanism::Matrix4 damping = jacobian.transpose() * loads.viscous.asDiagonal() * jacobian;
  const Eigen::LLT<mechanism::Matrix4> system(dynamics.mass + 0.5 * h * damping);
  if (system.info() != Eigen::Success) return false;
  const mechanism::Vector4 force = jacobian.transpose() * loads.motor_force - dynamics.bias + loads.pose_force;
  const mechanism::Vector4 momentum =
      dynamics.mass * state.pose_velocity - 0.5 * h * (damping * state.pose_velocity) + h * force;
  const mechanism::Vector4 free_velocity = system.solve(momentum);
  // Friction acts along the legs as they stand at the end: a held length then creeps by the third order of h only.
  const mechanism::Pose end = middle + 0.5 * h * (state.pose_velocity + h * state.last_acceleration);
  const mechanism::Matrix4 end_jacobian = mechanism::lengthJacobian(model.rigid.mechanism, end);
  const mechanism::Matrix4 response = system.solve(end_jacobian.transpose());
  const AxisContacts contacts_before = state.contacts;
  const ImpulseBox box = impulseBox(model, loads, mechanism::legLengths(model.rigid.mechanism, middle), h);
  const mechanism::Vector4 impulses =
      solveBoxFriction(end_jacobian * response, end_jacobian * free_velocity, box, state.contacts);
  mechanism::Vector4 velocity = free_velocity + response * impulses;
  if (allHeld(state.contacts)) velocity.setZero();  // four held lengths hold the pose; rounding must not creep
  if (!velocity.allFinite()) return false;

  const mechanism::Vector4 mean_velocity = 0.5 * (state.pose_velocity + velocity);
  const mechanism::Vector4 mean_rate = jacobian * mean_velocity;
  data.friction_force = impulses / h;
  data.motor_work_J += h * (loads.motor_force.dot(mean_rate) + loads.pose_force.dot(mean_velocity));
  data.dissipated_J +=
      h * mean_rate.dot(loads.viscous.cwiseProduct(mean_rate)) - impulses.dot(end_jacobian * mean_velocity);
  // A velocity that friction has just broken predicts nothing.
  const bool smooth = state.contacts == contacts_before && !allHeld(state.contacts);
  state.last_acceleration = smooth ? mechanism::Vector4((velocity - state.pose_velocity) / h)
                                   : mechanism::Vector4(mechanism::Vector4::Zero());
  state.pose = middle + 0.5 * h * velocity;
  state.pose_velocity = velocity;
  return true;
}

bool stepPlant(const PlantModel& model, const PlantLoads& loads, double dt, PlantState& state, PlantData& data) {
  data.motor_work_J = 0.0;
  data.dissipated_J = 0.0;
  const double h = dt / model.substeps;
  for (int i = 0; i < model.substeps; ++i) {
    if (!substepPlant(model, loads, h, state, data)) return false;
  }
  return true;
}

double totalEnergy(const PlantModel& model, const PlantState& state) {
  return dynamics::kineticEnergy(model.rigid, state.pose, state.pose_velocity) +
         dynamics::potentialEnergy(model.rigid, state.pose);
}

bool stepFrictionless(const PlantModel& model, const PlantLoads& loads, double dt, PlantState& state, PlantData& data) {
  const mechanism::Pose x = state.pose;
  const mechanism::Vector4 v = state.pose_velocity;
  const auto acceleration = [&](const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                                mechanism::Vector4& result) {
    const bool good =
        dynamics::forwardDynamics(model.rigid, pose, velocity, loads.motor_force, data.dynamics, loads.pose_force);
    result = data.dynamics.acceleration;
    return good && result.allFinite();
  };
  mechanism::Vector4 a1, a2, a3, a4;
  if (!acceleration(x, v, a1)) return false;
  const mechanism::Vector4 v2 = v + 0.5 * dt * a1;
  if (!acceleration(x + 0.5 * dt * v, v2, a2)) return false;
  const mechanism::Vector4 v3 = v + 0.5 * dt * a2;
  if (!acceleration(x + 0.5 * dt * v2, v3, a3)) return false;
  const mechanism::Vector4 v4 = v + dt * a3;
  if (!acceleration(x + dt * v3, v4, a4)) return false;
  state.pose = x + dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
  state.pose_velocity = v + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  return true;
}

}  // namespace knee_robot::simulation
