#pragma once

#include "knee_robot/identification/columns.h"
#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// How friction was loaded when each recording began, as far as the fit with these parameters (in the order of the
/// columns) tells: what it leaves while an actuator has not moved yet, as a share of its Coulomb friction. Fills
/// SlidingPath::loaded_at_start. Laws near rest are compared with it, so that none is preferred for what happened before
/// the recordings; of a recording to predict nobody knows it.
void findLoadedStart(const std::vector<Column>& columns, const Eigen::VectorXd& parameters, double cutoff_hz,
                     std::vector<Observation>& training);

/// Takes it out again.
void forgetLoadedStart(std::vector<Observation>& training);

}  // namespace knee_robot::identification
