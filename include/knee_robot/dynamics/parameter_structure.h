#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/dynamics/regressor.h"

namespace knee_robot::dynamics {

/// What a noise-free observation matrix W (rows: equations, columns: parameters) can tell apart: null columns, rank,
/// and which parameters are lumped into which base parameter. For the structure of a mechanism, stack W along rich
/// random motion; the number that one trajectory supports is `supported()` of its own W.
struct ParameterStructure {
  std::vector<int> null_columns;    ///< parameters without any effect (paper, Table 2)
  Eigen::VectorXd singular_values;  ///< of W with its other columns scaled to unit norm; largest first
  int rank = 0;                     ///< singular values above the tolerance times the largest
  std::vector<int> base;            ///< `rank` columns that span the others, ascending
  /// rank x parameters. Base parameter k = Phi[base[k]] + sum over the columns j not in `base` of lumping(k, j) Phi[j].
  Eigen::MatrixXd lumping;

  /// Singular values above `relative` times the largest: the directions that noise of this relative size leaves.
  int supported(double relative) const;
};

/// `tolerance` separates zero from not zero, relative to the largest singular value and to each column's norm. Base
/// columns are chosen in the order of `preferred` (empty: from the last column to the first, so that masses and the
/// platform are kept and inertias of the cylinders are lumped into them).
ParameterStructure parameterStructure(const Eigen::MatrixXd& w, double tolerance = 1e-9,
                                      const std::vector<int>& preferred = {});

/// "IZZ_12 + IZZ_11 - 0.4 m_M": base parameter k in names. Coefficients below 1e-6 are left out.
std::string combinationText(const ParameterStructure& structure, int k, const std::vector<std::string>& names);

/// Directions of the parameters that change the forces by more than `noise_N` (rms over the rows of `w`) when the
/// parameters change by their `typical` size (one per column, in the columns' units). Unlike relative counts it does
/// not depend on the number of samples, and says what a trajectory is good for.
int distinguishable(const Eigen::MatrixXd& w, const Eigen::VectorXd& typical, double noise_N);

/// K* (4 x 112 each) stacked along motions: 4 * motions rows. Motions at singular poses are left out.
Eigen::MatrixXd observationMatrix(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                                  const std::vector<mechanism::Motion>& motions);

}  // namespace knee_robot::dynamics
