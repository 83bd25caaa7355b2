#pragma once

#include <string>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/control_status.h"
#include "knee_robot/control/hardware_file.h"

namespace knee_robot::control {

/// Why guiding was refused, or ended by itself; empty for None.
const char* sentenceOf(GuideStop stop) noexcept;

/// What became of a request, as the operator is told. `now`: the machine after it.
Answer sentenceOf(RequestKind asked, const RequestAnswer& answer, const ControlStatus& now, HomingMethod homing,
                  double start_tolerance_m);

/// Of whoever asked for a motion before somebody else wanted the robot to stand.
inline const Answer kHalted{
    false,
    "somebody has stopped the robot, or changed who is on it, since this was asked for; ask again "
    "when it may move"};

/// Of whoever wanted the robot to go on before somebody else wanted it to wait.
inline const Answer kPaused{false,
                            "somebody has paused the robot since this was asked for; ask again when it may go on"};

}  // namespace knee_robot::control
