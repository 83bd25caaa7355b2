#include "knee_robot/simulation/effect_chain.h"

#include <Eigen/LU>
#include <cmath>

#include "knee_robot/dynamics/inverse_dynamics.h"

namespace knee_robot::simulation {
namespace {

constexpr double kAtRest = 1e-9;  ///< m/s

}  // namespace

EffectChain::EffectChain(const EffectPrototypes& prototypes, PlantModel& model) {
  for (const std::shared_ptr<const Effect>& prototype : prototypes) {
    effects_.push_back(prototype->clone());
    effects_.back()->changePlant(model);
  }
}

void EffectChain::start(const PlantModel& model, const PlantState& state) {
  at_.pose = state.pose;
  at_.lengths = mechanism::legLengths(model.rigid.mechanism, state.pose);
  mechanism::Motion rest;
  rest.pose = state.pose;
  mechanism::Vector4 weight = mechanism::Vector4::Zero();
  if (dynamics::inverseDynamics(model.rigid, rest, weight))
    at_.transmitted_N = weight;  // what carries the robot before it moves
  for (const auto& effect : effects_)
    effect->start(at_);
}

bool EffectChain::step(const PlantModel& model, const PlantLoads& loads, const PlantLoads& holds,
                       const mechanism::Vector4& driven, double dt, PlantState& state, PlantData& data) noexcept {
  data.motor_work_J = 0.0;
  data.dissipated_J = 0.0;
  const mechanism::Vector4 command = loads.motor_force.cwiseProduct(driven);
  unmodelled_.setZero();
  PlantLoads own = loads;
  for (const auto& effect : effects_)
    effect->changeForce(dt, own.motor_force);
  own.motor_force = own.motor_force.cwiseProduct(driven);
  const double h = dt / model.substeps;
  at_.dt_s = h;
  for (int i = 0; i < model.substeps; ++i) {
    acted_ = own;
    for (const auto& effect : effects_)
      effect->changeFriction(at_, acted_);
    for (const auto& effect : effects_)
      effect->addLoads(at_, acted_);
    acted_.viscous += holds.viscous;
    acted_.coulomb += holds.coulomb;
    if (!substepPlant(model, acted_, h, state, data)) return false;

    const mechanism::Vector4 before = at_.rates;
    at_.time_s += h;
    at_.pose = state.pose;
    at_.pose_velocity = state.pose_velocity;
    at_.lengths = mechanism::legLengths(model.rigid.mechanism, state.pose);
    at_.rates = mechanism::lengthJacobian(model.rigid.mechanism, state.pose) * state.pose_velocity;
    at_.transmitted_N = acted_.motor_force + data.friction_force -
                        0.5 * acted_.viscous.cwiseProduct(before + at_.rates) -
                        model.rigid.rotor_mass.cwiseProduct(at_.rates - before) / h;
    const mechanism::Vector4 pushed = mechanism::lengthJacobian(model.rigid.mechanism, state.pose)
                                          .transpose()
                                          .partialPivLu()
                                          .solve(mechanism::Vector4(acted_.pose_force - loads.pose_force));
    const mechanism::Vector4 sliding = at_.transmitted_N + pushed +
                                       0.5 * loads.viscous.cwiseProduct(before + at_.rates) +
                                       model.rigid.rotor_mass.cwiseProduct(at_.rates - before) / h;
    for (int axis = 0; axis < mechanism::kLegs; ++axis) {
      const double dry = loads.coulomb[axis], over = command[axis] - sliding[axis];
      const double rate = at_.rates[axis];
      // a held axis creeps by rounding and by the third order of the substep
      const bool slides =
          std::abs(rate) > kAtRest && state.contacts[static_cast<std::size_t>(axis)] != AxisContact::Held;
      double friction = slides ? std::copysign(dry, rate) : std::min(std::max(over, -dry), dry);
      for (const auto& effect : effects_)
        friction = effect->dryFriction(axis, dry, before[axis], rate, friction);
      unmodelled_[axis] += (over - friction) / model.substeps;
    }
    for (const auto& effect : effects_)
      effect->follow(at_);
  }
  return true;
}

mechanism::Lengths EffectChain::encoders(mechanism::Lengths lengths) const noexcept {
  for (const auto& effect : effects_)
    effect->changeEncoders(lengths);
  return lengths;
}

}  // namespace knee_robot::simulation
