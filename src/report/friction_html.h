#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::report {

/// The laws of friction near rest: one row an actuator, what was tried (where it is known), and each law around a reversal.
std::string frictionHtml(const std::vector<dynamics::FrictionLaw>& laws,
                         const std::vector<identification::FrictionChoice>& choices);

}  // namespace knee_robot::report
