#pragma once

#include <utility>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/robot_inertia.h"

namespace knee_robot::fake {

/// A model of `robot` with the weights of its URDF, and friction in the actuators.
inline dynamics::Model modelOf(const mechanism::Robot& robot, double viscous = 150.0, double coulomb = 15.0,
                               double coulomb_4 = 15.0) {
  dynamics::Model model;
  model.kind = robot.kind;
  model.axes = robot.axes();
  model.robot_fingerprint = robot.fingerprint;
  model.cutoff_hz = 3.0;
  model.moving_m_per_s = 0.001;
  model.data = {{"train.csv", "0123"}};
  model.rank = 1;
  model.friction.assign(4, dynamics::stopLaw(1e-4));
  model.residual_rms_N.assign(4, 1.0);
  const dynamics::InertialParameters links = dynamics::toParameters(dynamics::loadRobotInertia(robot));
  const std::vector<std::string>& names = dynamics::extendedParameterNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    dynamics::ModelParameter one;
    one.name = names[i];
    one.unit = "x";
    if (i < dynamics::kInertialParameters) one.value = links[static_cast<Eigen::Index>(i)];
    if (i >= dynamics::extended::kViscous && i < dynamics::extended::kCoulomb) one.value = viscous;
    if (i >= dynamics::extended::kCoulomb && i < dynamics::extended::kRotor) one.value = coulomb;
    if (i == dynamics::extended::kCoulomb + 3) one.value = coulomb_4;
    model.parameters.push_back(one);
  }
  model.base.push_back({1.0, 0.1, std::vector<double>(names.size(), 0.0)});
  return model;
}

/// modelOf(robot) with `effects`, traced beside the values that it has.
inline dynamics::Model tracedModelOf(const mechanism::Robot& robot, std::vector<dynamics::ModelEffect> effects) {
  dynamics::Model model = modelOf(robot);
  for (const dynamics::ModelParameter& one : model.parameters)
    model.effects_see.push_back(one.value);
  model.effects = std::move(effects);
  return model;
}

/// An actuator that answers `delay_s` late.
inline dynamics::ModelEffect delayOf(int actuator, double delay_s) {
  dynamics::ModelEffect effect;
  effect.name = "delay";
  effect.actuators = {actuator};
  effect.coefficients = {{"delay_s", delay_s, 1e-4}};
  return effect;
}

/// 10 N more at rest, falling off with 0.01 m/s.
inline dynamics::ModelEffect stribeckOf(int actuator) {
  dynamics::ModelEffect effect;
  effect.name = "stribeck";
  effect.actuators = {actuator};
  effect.shape = {{"velocity_m_per_s", 0.01, 0.001}};
  effect.coefficients = {{"excess_N", 10.0, 1.0}};
  return effect;
}

}  // namespace knee_robot::fake
