#pragma once

#include <Eigen/Core>

#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/identification/sliding_path.h"

namespace knee_robot::identification {

/// Share of full Coulomb friction after every substep of a path (SlidingPath::kSubsteps) of one element, whose own share
/// does not matter and which remembers `at_start` before the first: what dynamics::FrictionState::step says one substep
/// after the other, to rounding, in a fraction of its time.
Eigen::VectorXd elementAlong(const SlidingPath& path, const dynamics::FrictionElement& element, double at_start);

}  // namespace knee_robot::identification
