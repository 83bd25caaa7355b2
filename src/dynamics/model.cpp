#include "knee_robot/dynamics/model.h"

#include <algorithm>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "named_values.h"

namespace knee_robot::dynamics {
namespace {

/// Value of the named parameter among `values`; 0 when the model does not have it.
double valueOf(const Model& model, const std::vector<double>& values, const std::string& name) {
  const auto found = std::find_if(model.parameters.begin(), model.parameters.end(),
                                  [&](const ModelParameter& parameter) { return parameter.name == name; });
  return found == model.parameters.end() ? 0.0 : values[static_cast<std::size_t>(found - model.parameters.begin())];
}

std::vector<double> valuesOf(const Model& model) {
  if (const ModelElsewhere* numbers = numbersOfController(model)) return numbers->parameters;
  std::vector<double> values;
  for (const ModelParameter& p : model.parameters)
    values.push_back(p.value);
  return values;
}

}  // namespace

const ModelElsewhere* numbersOfController(const Model& model) {
  if (model.feedforward) return &model.feedforward->numbers;
  return model.elsewhere ? &*model.elsewhere : nullptr;
}

const std::vector<ModelEffect>& effectsOfController(const Model& model) {
  const ModelElsewhere* const numbers = numbersOfController(model);
  return numbers ? numbers->effects : model.effects;
}

std::vector<std::string> axisParameterNames(int axes) {
  std::vector<std::string> names;
  for (int i = 1; i <= axes; ++i) {
    for (const char* name : {"Fv_", "Fc_", "rotor_", "offset_"})
      names.push_back(name + std::to_string(i));
  }
  return names;
}

std::vector<std::string> chainParameterNames(int joints) {
  std::vector<std::string> names = chainInertialNames(joints);
  for (const char* name : {"Fv_", "Fc_", "rotor_", "offset_"}) {
    for (int i = 1; i <= joints; ++i)
      names.push_back(name + std::to_string(i));
  }
  return names;
}

std::vector<ModelJoint> modelJoints(const mechanism::Robot& robot) {
  std::vector<ModelJoint> joints;
  if (robot.kind != mechanism::MechanismKind::Chain) return joints;
  for (const mechanism::Actuator& a : robot.actuators)
    joints.push_back({a.name, a.revolute, mechanism::forceUnit(a), a.torque_per_ampere, a.torque_per_ampere_std});
  return joints;
}

void requireModelOf(const Model& model, const std::string& model_path, const mechanism::Robot& robot) {
  if (model.kind != robot.kind || model.axes != robot.axes()) {
    throw InputError(model_path + ": is the model of another mechanism than " + robot.path +
                     "; identify this robot first");
  }
  if (model.robot_fingerprint != robot.fingerprint) {
    throw InputError(model_path + ": was identified with another version of the robot file (" +
                     model.robot_fingerprint + ") than " + robot.path + " (" + robot.fingerprint + "); identify again");
  }
}

ExtendedParameters extendedValues(const Model& model, const std::vector<double>& values) {
  ExtendedParameters out;
  const std::vector<std::string>& names = extendedParameterNames();
  for (int i = 0; i < extended::kParameters; ++i)
    out[i] = valueOf(model, values, names[static_cast<std::size_t>(i)]);
  return out;
}

mechanism::Matrix4 axisValues(const Model& model, const std::vector<double>& values) {
  mechanism::Matrix4 out = mechanism::Matrix4::Zero();
  const std::vector<std::string> names = axisParameterNames(model.axes);
  for (int i = 0; i < model.axes; ++i) {
    for (int k = 0; k < 4; ++k)
      out(k, i) = valueOf(model, values, names[static_cast<std::size_t>(4 * i + k)]);
  }
  return out;
}

ForceModel::ForceModel(const Model& model, const mechanism::Robot& robot)
    : mechanism(robot.mechanism), gravity(robot.gravity), axes(model.axes), effects(model, robot) {
  if (robot.kind == mechanism::MechanismKind::Chain)
    throw InputError(robot.path + ": is a chain; its model predicts recordings, and drives no controller");
  const std::vector<double> values = valuesOf(model);
  parameters.setZero();
  axis_parameters.setZero();
  const std::vector<FrictionLaw>& laws = model.feedforward ? model.feedforward->friction : model.friction;
  for (int i = 0; i < axes; ++i)
    friction[static_cast<std::size_t>(i)] = laws[static_cast<std::size_t>(i)];
  if (mechanism) {
    parameters = extendedValues(model, values);
    coulomb = parameters.segment<mechanism::kLegs>(extended::kCoulomb);
    parameters.segment<mechanism::kLegs>(extended::kCoulomb).setZero();
    return;
  }
  axis_parameters = axisValues(model, values);
  coulomb = axis_parameters.row(1).transpose();
  axis_parameters.row(1).setZero();
}

}  // namespace knee_robot::dynamics
