#pragma once

#include <vector>

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {

/// Error of the fit with one number of coordinates. Errors are mean squares in units of the noise.
struct RankPoint {
  int rank = 0;
  double strength = 0.0;  ///< of the prior, where that was chosen: then rank counts the directions that the data decide
  double training = 0.0;  ///< on the data that was fitted
  double held_back = 0.0;       ///< on blocks of the training data that were left out in turn
  double beyond_best = 0.0;     ///< held_back minus that of the best rank
  double standard_error = 0.0;  ///< of beyond_best, over the blocks (same blocks, paired differences)
};

/// Error against rank, and the choice.
struct RankChoice {
  int rank = 0;
  double strength = 0.0;
  std::vector<RankPoint> curve;
};

/// Leaves out one block of the (weighted) equations after the other. Chosen is the smallest rank whose held-back error
/// exceeds that of the best one by no more than one standard error of the difference. Training data only.
RankChoice chooseRank(const Equations& equations, const std::vector<Column>& columns, const std::vector<char>& use);

/// The same over the strength of the prior, weakest last: all directions are fitted, and pulled towards the prior.
/// Chosen is the strongest pull within one standard error of the best.
RankChoice chooseStrength(const Equations& equations, const std::vector<Column>& columns, const std::vector<char>& use,
                          const Prior& prior);

/// Parameters for every point of a curve of chooseStrength, fitted to all equations.
std::vector<Eigen::VectorXd> parametersByStrength(const Reduction& reduction, const RankChoice& choice);

/// Directions, friction and rotors included, that the data decide rather than the prior at this strength.
int supportedRank(const Reduction& reduction, double strength);

/// compress() of the rows of each block.
std::vector<Eigen::MatrixXd> compressBlocks(const Equations& equations);

/// Compressed blocks on top of each other, compressed again, without block `left_out` (-1: all).
Eigen::MatrixXd joinBlocks(const std::vector<Eigen::MatrixXd>& blocks, int left_out);

}  // namespace knee_robot::identification
