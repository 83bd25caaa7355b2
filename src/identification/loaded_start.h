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

/// The share per actuator that training recordings began with, where two or more tell it and agree: every one of them is
/// nearer to the mean of the others than to nothing. Of it the share with which a further one does so, by Laplace's rule of
/// succession: n of n + 1. 0 elsewhere.
std::vector<double> usualStart(const std::vector<Observation>& training);

/// The same of a law's elements that remember, which hold all of it: for FrictionLaw::at_start.
double ofThoseThatRemember(const dynamics::FrictionLaw& law, double share);

/// Takes it out again.
void forgetLoadedStart(std::vector<Observation>& training);

}  // namespace knee_robot::identification
