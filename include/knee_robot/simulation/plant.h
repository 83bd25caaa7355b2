#pragma once

#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/simulation/box_friction.h"

namespace knee_robot::simulation {

/// The mechanism as a plant: rigid links and rotors of `rigid`, stops at the ends of each stroke.
struct PlantModel {
  PlantModel(dynamics::RigidModel rigid_model, const mechanism::Lengths& shortest, const mechanism::Lengths& longest)
      : rigid(std::move(rigid_model)), shortest_m(shortest), longest_m(longest) {}

  dynamics::RigidModel rigid;
  mechanism::Lengths shortest_m;  ///< mechanical stops, inelastic
  mechanism::Lengths longest_m;
  int substeps = 4;  ///< of every stepPlant
};

/// What acts on the plant during one step.
struct PlantLoads {
  mechanism::Vector4 motor_force = mechanism::Vector4::Zero();  ///< N, positive lengthens the leg
  mechanism::Vector4 viscous = mechanism::Vector4::Zero();      ///< N s/m: friction, and a motor with shorted windings
  mechanism::Vector4 coulomb = mechanism::Vector4::Zero();      ///< N: friction, and an engaged brake
  mechanism::Vector4 coulomb_asymmetry =
      mechanism::Vector4::Zero();  ///< N: more of it against lengthening, less against shortening
  mechanism::Vector4 pose_force =
      mechanism::Vector4::Zero();  ///< N, N, N m, N m on the pose coordinates: a person, a spring, passive joints
};

/// Everything that the plant integrates.
struct PlantState {
  mechanism::Pose pose = mechanism::Pose::Zero();
  mechanism::Vector4 pose_velocity = mechanism::Vector4::Zero();
  AxisContacts contacts{};  ///< of the last substep
  mechanism::Vector4 last_acceleration =
      mechanism::Vector4::Zero();  ///< of the last substep, predicts the velocity terms of the next
};

/// Workspace, and the books of the last stepPlant.
struct PlantData {
  dynamics::ForwardDynamicsData dynamics;
  mechanism::Vector4 friction_force =
      mechanism::Vector4::Zero();  ///< N, mean over the last substep: Coulomb, brakes and stops, not viscous
  double motor_work_J = 0.0;       ///< by motor_force and pose_force during the last stepPlant
  double dissipated_J = 0.0;       ///< by viscous and Coulomb friction, brakes and stops during it
};

/// Advances `state` by dt seconds in model.substeps substeps, loads constant. Each substep is one midpoint step of the
/// smooth part (second order), viscous friction by the trapezoidal rule (stable however strong), Coulomb friction,
/// brakes and stops by solveBoxFriction at the end velocity: an axis that friction can hold has exactly zero velocity,
/// and when all four are held the pose does not change by a bit. False when the mass matrix is not positive definite or
/// the state is not finite; the state is then that of the last good substep. Real-time safe.
bool stepPlant(const PlantModel& model, const PlantLoads& loads, double dt, PlantState& state, PlantData& data);
/// One substep of h seconds of it, for loads that change between substeps; adds to the books of `data`.
bool substepPlant(const PlantModel& model, const PlantLoads& loads, double h, PlantState& state, PlantData& data);

/// Kinetic and potential energy (J): for the energy test.
double totalEnergy(const PlantModel& model, const PlantState& state);

/// Accurate integrator for frictionless motion (classical Runge-Kutta, fourth order): constant forces for dt seconds.
/// Ignores viscous, coulomb and stops. The measure for stepPlant, and for the energy test. False as stepPlant.
bool stepFrictionless(const PlantModel& model, const PlantLoads& loads, double dt, PlantState& state, PlantData& data);

}  // namespace knee_robot::simulation
