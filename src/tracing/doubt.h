#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Noise floors that models with the right effects leave while axes move, at most 2.1 on 19 machines of two independent
/// simulators; those with names that stand for something else left 2.6 to 11 (docs/results/blind_simulators.md, the
/// fourth). All of them had repeats. A floor that was estimated says too little to take a name away: where axes stick, a
/// healthy robot leaves ten of them.
constexpr double kRightLeaves = 2.2;

/// Probability of a name below which it is rather none: the effect is reported as unnamed.
constexpr double kEven = 0.5;

/// Where an effect acts: on its actuator, or on all together; 0 when nothing is known (empty, of a given model).
double atPlace(const Place& place, const Eigen::VectorXd& per_actuator_N);

/// Noise floors in `left_N` (per actuator) where an effect acts; of one on all actuators, of them together.
double floorsLeft(const Search& search, const Place& place, const Eigen::VectorXd& left_N);

/// Names of models that leave much more than the noise floor while axes move are less probable, the more they leave;
/// those that are rather wrong than right are doubted.
void doubtNames(Search& search, std::vector<std::string>& notes);

}  // namespace knee_robot::tracing
