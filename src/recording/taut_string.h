#pragma once

#include <Eigen/Core>

namespace knee_robot::recording {

/// The shortest line through the band of half width `half` around evenly spaced values (a taut string): what a rounded
/// signal may have been that moves least. It stands still where the values tremble within the band.
Eigen::VectorXd tautString(const Eigen::VectorXd& values, double half);

}  // namespace knee_robot::recording
