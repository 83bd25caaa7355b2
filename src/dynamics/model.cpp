#include "knee_robot/dynamics/model.h"

#include <algorithm>

#include "knee_robot/base/errors.h"

namespace knee_robot::dynamics {
namespace {

/// Value of the named parameter; 0 when the model does not have it.
double valueOf(const Model& model, const std::string& name) {
  const auto found = std::find_if(model.parameters.begin(), model.parameters.end(),
                                  [&](const ModelParameter& parameter) { return parameter.name == name; });
  return found == model.parameters.end() ? 0.0 : found->value;
}

}  // namespace

std::vector<std::string> axisParameterNames(int axes) {
  std::vector<std::string> names;
  for (int i = 1; i <= axes; ++i) {
    for (const char* name : {"Fv_", "Fc_", "rotor_", "offset_"})
      names.push_back(name + std::to_string(i));
  }
  return names;
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

ForceModel::ForceModel(const Model& model, const mechanism::Robot& robot)
    : mechanism(robot.mechanism), gravity(robot.gravity), axes(model.axes) {
  if (!model.effects.empty()) {
    throw InputError("the model has an effect (" + model.effects.front().name +
                     ") that is predicted along whole recordings only, not instant by instant; use the model that "
                     "identify writes, or predict");
  }
  parameters.setZero();
  axis_parameters.setZero();
  coulomb.setZero();
  for (int i = 0; i < axes; ++i)
    friction[static_cast<std::size_t>(i)] = model.friction[static_cast<std::size_t>(i)];
  if (mechanism) {
    const std::vector<std::string>& names = extendedParameterNames();
    for (int i = 0; i < extended::kParameters; ++i)
      parameters[i] = valueOf(model, names[static_cast<std::size_t>(i)]);
    coulomb = parameters.segment<mechanism::kLegs>(extended::kCoulomb);
    parameters.segment<mechanism::kLegs>(extended::kCoulomb).setZero();
    return;
  }
  const std::vector<std::string> names = axisParameterNames(axes);
  for (int i = 0; i < axes; ++i) {
    for (int k = 0; k < 4; ++k)
      axis_parameters(k, i) = valueOf(model, names[static_cast<std::size_t>(4 * i + k)]);
    coulomb[i] = axis_parameters(1, i);
    axis_parameters(1, i) = 0.0;
  }
}

bool forceFromModel(const ForceModel& model, const mechanism::Vector4& position, const mechanism::Vector4& velocity,
                    const mechanism::Vector4& acceleration, const mechanism::Motion& motion, ForceModelData& data,
                    mechanism::Vector4& forces, double period_s) noexcept {
  mechanism::Vector4 smooth;
  if (model.mechanism) {
    if (!extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.row)) return false;
    smooth.noalias() = data.row * model.parameters;
  } else {
    smooth.setZero();
    for (int i = 0; i < model.axes; ++i) {
      smooth[i] = actuatorRegressor(velocity[i], acceleration[i]).dot(model.axis_parameters.col(i));
    }
  }
  for (int i = 0; i < model.axes; ++i) {
    const double displacement = data.started ? position[i] - data.last_position[i] : 0.0;
    const std::size_t axis = static_cast<std::size_t>(i);
    smooth[i] += model.coulomb[i] * data.memory[axis].step(model.friction[axis], displacement, period_s);
  }
  data.last_position = position;
  data.started = true;
  forces = smooth;
  return true;
}

}  // namespace knee_robot::dynamics
