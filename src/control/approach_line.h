#pragma once

#include "knee_robot/control/axis_data.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/reference_file.h"

namespace knee_robot::control {

/// Rest to rest on a straight line in actuator space, minimum jerk, no axis faster than `speed_m_per_s` or with more
/// than half of its acceleration limit; at least half a second. N x 4 lengths (m), one each trajectory::kStreamPeriod,
/// both ends included.
trajectory::Points approachLine(const AxisValues& from_m, const AxisValues& to_m, const mechanism::Robot& robot,
                                double speed_m_per_s);

}  // namespace knee_robot::control
