#pragma once

#include <string>
#include <vector>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/dynamics/friction_law.h"

namespace knee_robot::dynamics {

/// Laws near rest of a model file under `key`: one entry per actuator.
std::string frictionText(const std::vector<FrictionLaw>& laws, const std::string& key);
/// `revolute`: one entry an actuator, or empty where none is.
std::vector<FrictionLaw> readFriction(StrictMap& file, const std::string& key, int axes,
                                      const std::vector<char>& revolute = {});

}  // namespace knee_robot::dynamics
