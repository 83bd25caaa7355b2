#pragma once

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {

/// Result of robustFit.
struct RobustFit {
  Eigen::VectorXd coordinates;  ///< of the Reduction: kept columns, then directions
  Eigen::MatrixXd covariance;   ///< of the coordinates, by the block bootstrap
  Eigen::VectorXd weights;      ///< per equation: what the loss function leaves of it, 1 or less
  double block_s = 0.0;         ///< length of the bootstrap's blocks
  int iterations = 0;
  double outlier_share = 0.0;  ///< of the equations that count less than half
};

/// How equations with large residuals are treated.
enum class OutlierRule {
  Huber,  ///< a residual beyond 1.345 times the noise counts linearly (Ceres)
  Bisquare,  ///< iteratively reweighted least squares with Tukey's weights: beyond 4.685 times the scale (median) it counts nothing
  None,  ///< plain least squares
};

/// Refines the truncated least-squares solution: robust, and with bounds that keep friction and rotor inertia from
/// becoming negative.
/// `equations` are the weighted ones that `reduction` was made from. The covariance comes from a block bootstrap, so
/// that residuals may be correlated in time; it is left empty without `uncertainty`. `strength`: of the prior, when the
/// reduction has one. Throws std::runtime_error when Ceres fails, which data cannot cause.
RobustFit robustFit(const Equations& equations, const Reduction& reduction, int rank,
                    OutlierRule rule = OutlierRule::Huber, double strength = 0.0, bool uncertainty = true);

}  // namespace knee_robot::identification
