#pragma once

#include <vector>

#include "knee_robot/identification/identify.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {

/// One recording as `identify` sees it.
inline std::vector<Observation> observeOne(const mechanism::Robot& robot, const recording::Recording& r,
                                           const IdentifyOptions& options) {
  return {observe(robot, columnsOf(robot), r, options.observation)};
}

}  // namespace knee_robot::identification
