#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/identification/columns.h"
#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/prior.h"

namespace knee_robot::identification {

/// A linear least-squares problem in coordinates on which a prior pulls with equal strength. Columns with a physical sign
/// (friction, rotor inertia) are kept as they are, scaled to unit norm; of all others only combinations count that those
/// do not explain: the singular directions of the others, in the prior's units, after projecting the kept columns out;
/// strongest first.
struct Reduction {
  std::vector<int> kept;       ///< columns with a physical sign that occur in the data
  std::vector<int> others;     ///< all other columns that occur in the data
  Eigen::VectorXd scale;       ///< per column with a sign: its norm (0: does not occur); 1 for the others
  Eigen::MatrixXd directions;  ///< others x directions
  Eigen::VectorXd singular;    ///< per direction, relative to the strongest
  Eigen::MatrixXd design;      ///< compressed equations: kept columns (scaled), then the directions
  Eigen::VectorXd target;      ///< compressed right-hand side
  Eigen::VectorXd start;       ///< parameters where all coordinates are zero: the prior's mean
  Eigen::VectorXd
      information;  ///< per direction: sum of squares that a change as large as the prior makes in the equations

  int maximalRank() const { return static_cast<int>(design.cols()); }
  int minimalRank() const { return static_cast<int>(kept.size()); }
};

/// Triangular factor of [a b] by QR: the same least-squares problem in few rows.
Eigen::MatrixXd compress(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// compress() of the rows of each block.
std::vector<Eigen::MatrixXd> compressBlocks(const Equations& equations);

/// Compressed blocks on top of each other, compressed again, without block `left_out` (-1: all).
Eigen::MatrixXd joinBlocks(const std::vector<Eigen::MatrixXd>& blocks, int left_out);
/// joinBlocks() without each block in turn.
std::vector<Eigen::MatrixXd> joinOthers(const std::vector<Eigen::MatrixXd>& blocks);

/// `triangle` is compress(a, b), or several of them stacked. Directions of which the data say next to nothing (information below 1e-4) are
/// dropped: they stay at the prior's mean. Columns with a sign for which `use` is 0 are left out.
Reduction reduce(const Eigen::MatrixXd& triangle, const std::vector<Column>& columns, const std::vector<char>& use,
                 const Prior& prior);

/// Coordinates of the least-squares solution with the prior: |design z - target|^2 + strength |directions of z|^2, no
/// kept column negative.
Eigen::VectorXd solveWithPrior(const Reduction& reduction, int rank, double strength);

/// Parameters (all columns, unscaled) that belong to coordinates.
Eigen::VectorXd toParameters(const Reduction& reduction, const Eigen::VectorXd& coordinates);

/// Least squares min |x z - y| with z[i] >= 0 for i < bounded, by an active set.
Eigen::VectorXd boundedLeastSquares(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, int bounded);

}  // namespace knee_robot::identification
