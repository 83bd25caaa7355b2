#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/identification/columns.h"
#include "knee_robot/identification/prior.h"

namespace knee_robot::identification {

/// A linear least-squares problem prepared for truncation. Columns with a physical sign (friction, rotor inertia) are
/// kept as they are; of all others only combinations count that those do not explain: the singular directions of the
/// others after projecting the kept columns out, strongest first. All columns are scaled to unit mean square first.
struct Reduction {
  std::vector<int> kept;       ///< columns with a physical sign that occur in the data
  std::vector<int> others;     ///< all other columns that occur in the data
  Eigen::VectorXd scale;       ///< per column of the problem: its root mean square; 0: does not occur
  Eigen::MatrixXd directions;  ///< others x directions, orthonormal, in scaled columns
  Eigen::VectorXd singular;    ///< per direction, relative to the strongest
  Eigen::MatrixXd design;      ///< compressed equations: kept columns (scaled), then the directions
  Eigen::VectorXd target;      ///< compressed right-hand side
  // With a prior only:
  Eigen::VectorXd start;  ///< parameters where all coordinates are zero; empty: zero
  Eigen::VectorXd
      information;  ///< per direction: sum of squares that a change as large as the prior makes in the equations

  int maximalRank() const { return static_cast<int>(design.cols()); }
  int minimalRank() const { return static_cast<int>(kept.size()); }
};

/// Triangular factor of [a b] by QR: the same least-squares problem in few rows.
Eigen::MatrixXd compress(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// `triangle` is compress(a, b) of `rows` equations (or several of them stacked). Directions weaker than 1e-9 of the
/// strongest are dropped. Columns for which `use` is 0 are left out.
Reduction reduce(const Eigen::MatrixXd& triangle, int rows, const std::vector<Column>& columns,
                 const std::vector<char>& use);

/// The same with a prior: directions are those of the prior's unit coordinates, so that a pull of equal strength on
/// each is a pull towards the prior. Directions of which the data say next to nothing (information below 1e-4) are
/// dropped: they stay at the prior's mean.
Reduction reduce(const Eigen::MatrixXd& triangle, const std::vector<Column>& columns, const std::vector<char>& use,
                 const Prior& prior);

/// Coordinates of the least-squares solution with the prior: |design z - target|^2 + strength |directions of z|^2, no
/// kept column negative.
Eigen::VectorXd solveWithPrior(const Reduction& reduction, int rank, double strength);

/// Coordinates (kept columns, then directions; scaled) of the least-squares solution with `rank` coordinates in which
/// no kept column is negative. rank is between minimalRank() and maximalRank().
Eigen::VectorXd solveReduced(const Reduction& reduction, int rank);

/// solveReduced for every rank from minimalRank() to maximalRank(): one factorization, because the columns are nested;
/// only ranks at which a bound is active are solved on their own.
std::vector<Eigen::VectorXd> solveEveryRank(const Reduction& reduction);

/// Parameters (all columns, unscaled) that belong to coordinates.
Eigen::VectorXd toParameters(const Reduction& reduction, const Eigen::VectorXd& coordinates);

/// Least squares min |x z - y| with z[i] >= 0 for i < bounded, by an active set.
Eigen::VectorXd boundedLeastSquares(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, int bounded);

}  // namespace knee_robot::identification
