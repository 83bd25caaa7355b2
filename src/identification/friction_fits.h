#pragma once

#include <Eigen/Core>
#include <vector>

namespace knee_robot::identification {

inline constexpr double kLeastOfWeights = 0.1;  ///< of the sum of weights

/// Sums of squares of one block of rows: everything but one actuator's own dry friction (base), and many candidate
/// columns for it. The first of these may stand beside others in a law, the rest stand alone.
struct FrictionBlock {
  Eigen::MatrixXd base;        ///< base' base
  Eigen::MatrixXd mixed;       ///< base' candidates
  Eigen::MatrixXd candidates;  ///< candidates' candidates, of those that may stand beside others
  Eigen::VectorXd own;         ///< of every candidate its own square
  Eigen::VectorXd base_target, candidate_target;
  double target = 0.0;
  double rows = 0.0;

  FrictionBlock& operator+=(const FrictionBlock& o);
  FrictionBlock minus(const FrictionBlock& o) const;
};

/// The squared residual as a function of the candidates' weights w alone, the base the best one for every w: constant -
/// 2 w' linear + w' square w.
struct InWeights {
  double constant = 0.0;
  Eigen::VectorXd linear;
  Eigen::MatrixXd square;  ///< of candidates that may stand beside others
  Eigen::VectorXd own;     ///< the diagonal, of all

  double product(int i, int j) const { return i == j ? own[i] : square(i, j); }
  double at(const std::vector<int>& which, const Eigen::VectorXd& weights) const;
  /// The multiple of `direction` that leaves least.
  double along(const std::vector<int>& which, const Eigen::VectorXd& direction) const;
};

/// A base that was fitted for every weights w of the candidates: alone - follows w.
struct FittedBase {
  Eigen::VectorXd alone;
  Eigen::MatrixXd follows;

  /// Squared residual on other rows.
  double leftOn(const FrictionBlock& other, const std::vector<int>& which, const Eigen::VectorXd& weights) const;
};

/// Eliminates the base, with a ridge on its coordinates, and says what that leaves on the same rows.
FittedBase eliminateBase(const FrictionBlock& fitted, const Eigen::VectorXd& ridge, InWeights& left);

/// Non-negative weights of these few columns that leave least. Empty when some weight would be less than `least_share`
/// of their sum: what carries so little is the shape of its neighbours, not a law.
Eigen::VectorXd positiveWeights(const InWeights& training, const std::vector<int>& which,
                                double least_share = kLeastOfWeights);

/// The same of two columns, without an allocation. Returns what they leave; infinity when the weights are empty.
double leftByPair(const InWeights& training, int first, int second);

}  // namespace knee_robot::identification
