#pragma once

#include <Eigen/Core>
#include <vector>

namespace knee_robot::identification {

/// Sums of squares of one block of rows: everything but one actuator's own dry friction (base), and many candidate
/// columns for it.
struct FrictionBlock {
  Eigen::MatrixXd base;        ///< base' base
  Eigen::MatrixXd mixed;       ///< base' candidates
  Eigen::MatrixXd candidates;  ///< candidates' candidates
  Eigen::VectorXd base_target, candidate_target;
  double target = 0.0;
  double rows = 0.0;

  FrictionBlock& operator+=(const FrictionBlock& o);
  FrictionBlock minus(const FrictionBlock& o) const;
};

/// The squared residual as a function of the candidates' weights w alone: constant - 2 w' linear + w' square w. On the
/// rows that were fitted the base is the best one for every w; on other rows it is that same base.
struct InWeights {
  double constant = 0.0;
  Eigen::VectorXd linear;
  Eigen::MatrixXd square;

  double at(const std::vector<int>& which, const Eigen::VectorXd& weights) const;
};

/// Eliminates the base on `fitted` rows (with a ridge on its coordinates) and says what that leaves on them and on
/// `other`.
void eliminateBase(const FrictionBlock& fitted, const FrictionBlock& other, const Eigen::VectorXd& ridge,
                   InWeights& training, InWeights& held_back);

/// Non-negative weights of these few columns that leave least. Empty when some weight would be less than `least_share`
/// of their sum: what carries so little is the shape of its neighbours, not a law.
Eigen::VectorXd positiveWeights(const InWeights& training, const std::vector<int>& which, double least_share = 0.1);

}  // namespace knee_robot::identification
