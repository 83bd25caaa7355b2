#pragma once

#include <string>

#include "knee_robot/mechanism/robot.h"

namespace knee_robot::mechanism {

/// config/robots/NAME.yaml of this repository.
inline Robot configuredRobot(const std::string& name) {
  return loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + name + ".yaml");
}

}  // namespace knee_robot::mechanism
