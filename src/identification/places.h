#pragma once

#include <Eigen/Core>
#include <vector>

namespace knee_robot::identification {

/// For every sample of a motion the first sample at which the robot was at the same place: the same positions and
/// velocities, each within a fifth of its standard deviation over the motion. A repeated motion says nothing new:
/// cross-validation has to leave out all visits of a place together, or it asks the model for what it has been told.
///
/// `state`: a row a sample, positions and velocities; `run`: per sample, number of the contiguous stretch that it
/// belongs to. Samples of one stretch that come to the same place stay on their own. Every entry points to an entry
/// that points to itself.
std::vector<int> firstVisits(const Eigen::MatrixXd& state, const std::vector<int>& run);

}  // namespace knee_robot::identification
