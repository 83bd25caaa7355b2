#pragma once

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot {

/// Result of robustFit.
struct RobustFit {
  Eigen::VectorXd coordinates;  ///< of the Reduction: kept columns, then directions
  Eigen::MatrixXd covariance;   ///< of the coordinates
  int iterations = 0;
  double outlier_share = 0.0;  ///< of the equations that the loss function bends
};

/// Refines the truncated least-squares solution with Ceres: Huber's loss (a residual beyond 1.345 times the noise counts
/// linearly) and bounds that keep friction and rotor inertia from becoming negative. `equations` are the weighted ones that
/// `reduction` was made from. The covariance allows for residuals that are correlated in time: it sums the gradients of whole
/// seconds (cluster-robust), not of samples. Throws std::runtime_error when Ceres fails, which data cannot cause.
RobustFit robustFit(const Equations& equations, const Reduction& reduction, int rank);

}  // namespace knee_robot
