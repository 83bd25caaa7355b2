#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/equations.h"

namespace knee_robot::identification {

/// Why a model that was fitted to `training` (observed with `columns`, Coulomb columns set) may not describe it at all:
/// forces of the wrong sign, exchanged columns, wrong units, clocks that differ. One sentence each, empty for a sound
/// fit. `parameters`: per column.
std::vector<std::string> doubtsAboutFit(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                        const Eigen::VectorXd& parameters, const std::vector<Observation>& training,
                                        const ObservationOptions& options);

}  // namespace knee_robot::identification
