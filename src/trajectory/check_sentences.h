#pragma once

#include <string>

#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::trajectory {

/// FILE:LINE, actuator, value, limit and how to mend it, for a limit that `reference` violates at `at`.
std::string violationSentence(const Margin& at, const Reference& reference, const mechanism::Robot& robot);

}  // namespace knee_robot::trajectory
