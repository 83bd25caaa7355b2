#pragma once

#include <Eigen/Core>

#include "knee_robot/identification/equations.h"

namespace knee_robot::identification {

/// Block length that the residual's autocorrelation asks for: the automatic choice of Politis and White (2004,
/// corrected 2009) on each actuator's residual, the longest of them. Between one sample of the equations and a twelfth
/// of the data, s.
double bootstrapBlock_s(const Equations& equations, const Eigen::VectorXd& residual);

/// Draws of a least-squares solution.
struct Bootstrap {
  double block_s = 0.0;   ///< length of the blocks
  int blocks = 0;         ///< of the data
  Eigen::MatrixXd draws;  ///< coordinates x draws

  /// Covariance of the coordinates over the draws.
  Eigen::MatrixXd covariance() const;
};

/// Block bootstrap of min |x z - b| with z[i] >= 0 for i < bounded: the data are cut into contiguous blocks, which keep
/// all actuators and all correlation in time together, and every draw weights the blocks with exponential random
/// numbers (Rubin's Bayesian bootstrap: no draw loses a direction that only one block excites). `x` and `b` have one
/// row per row of `equations`. `ridge`, per coordinate: a pull towards zero that every draw has, or empty. The same
/// `seed` gives the same draws.
Bootstrap blockBootstrap(const Equations& equations, const Eigen::MatrixXd& x, const Eigen::VectorXd& b, int bounded,
                         double block_s, int draws = 300, unsigned seed = 1, const Eigen::VectorXd& ridge = {});

}  // namespace knee_robot::identification
