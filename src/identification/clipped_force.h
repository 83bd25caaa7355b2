#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// A recorded force that is cut off below the robot file's limit: again and again it stands exactly at its own largest
/// (or smallest) value while the axis moves, though otherwise it changes from row to row.
struct ClippedForce {
  std::vector<char> rows;  ///< 1 where some axis' force is cut off; empty: none is
  std::string where;       ///< "force_2_N stands at 20 N": the first such axis; empty: none
};

/// `moving_m_per_s`: per actuator, movingLimits.
ClippedForce findClipped(const mechanism::Robot& robot, const Eigen::VectorXd& moving_m_per_s,
                         const Observation& observation);

}  // namespace knee_robot::identification
