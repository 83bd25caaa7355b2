#pragma once

#include <string>

#include "knee_robot/control/hardware_file.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// Whether the axes of a parallel robot that stands about at home can be homed one after the other as the hardware file says: on
/// the way to a switch or stop, and back from it, no pose may be near a singularity. There an axis cannot go on, stands as
/// it does at its stop, at the same place each time, and its length would be wrong by centimetres. Empty where they can or
/// nothing moves; otherwise a sentence about the first axis that cannot.
std::string whyNotHomed(const mechanism::Robot& robot, const HardwareFile& hardware);

}  // namespace knee_robot::control
