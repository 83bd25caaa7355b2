#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// One sentence when the model describes training forces much better that are taken earlier or later by 0.1 to 1 s
/// than recorded: positions and forces were stamped by different clocks, or by what arrived late. Empty otherwise. What
/// a drive or a filter delays is shorter, and tracing's (delay, drive_lag, sensor_lag).
std::string doubtAboutClocks(const mechanism::Robot& robot, const std::vector<Column>& columns,
                             const std::vector<Observation>& training, const ObservationOptions& options);

}  // namespace knee_robot::identification
