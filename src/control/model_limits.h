#pragma once

#include <string>

#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// Whether a model asks more than `share` of what a drive gives (Actuator::forceLimit) at home and up to 20 mm around
/// it, at rest or in a gentle motion of half a second (50 mm/s, 0.1 m/s^2): numbers that no machine has, which would
/// throw the platform as soon as the brakes open or an axis starts. So would friction that pushes. A clause without its subject, or empty. Without a
/// platform nothing is asked.
std::string whatIsTooMuch(const dynamics::PartedModel& model, const mechanism::Robot& robot, double share);

}  // namespace knee_robot::control
