#pragma once

#include <memory>
#include <string>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/model.h"

namespace knee_robot::dynamics {

/// What is made (Made(model, robot)) of a model file of this robot. InputError names the file and the reason.
template <typename Made>
std::unique_ptr<Made> ofModelFile(const std::string& path, const mechanism::Robot& robot) {
  const Model read = loadModel(path);
  requireModelOf(read, path, robot);
  try {
    return std::make_unique<Made>(read, robot);
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
}

}  // namespace knee_robot::dynamics
