#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace knee_robot::tracing {

/// Of the mean of these values.
double standardError(const Eigen::VectorXd& values);

/// What held-back blocks gained by an explanation: mean over blocks, its standard error, share of the blocks that gain.
/// Where all of ten blocks or more gain, the sign test speaks: chance brings that in less than one of a thousand,
/// however unequal they gain, and the error is at most a third of the mean.
struct HeldBackGain {
  double mean = 0.0, error = 0.0, gaining = 0.0;
};
HeldBackGain heldBackGain(const Eigen::VectorXd& per_block);

constexpr double kSureOfName = 0.8;  ///< probability of a name below which its rivals are named too

/// Probability that the mean over blocks of `difference` is positive (normal approximation).
double probabilityPositive(const Eigen::VectorXd& difference);

/// What surrogates explain by chance. A place's values are standardized by their own mean and spread, because artefacts
/// favour some explanations over others; the null of the search is the largest standardized value of all places.
struct MaxNull {
  Eigen::VectorXd mean, spread;  ///< per place, of the root of the explained square
  std::vector<double> largest;   ///< per surrogate, ascending

  double standardized(Eigen::Index place, double root) const { return (root - mean[place]) / spread[place]; }
  /// Root of the square that a place would need to reach the largest null value.
  double threshold(Eigen::Index place) const { return mean[place] + spread[place] * largest.back(); }
  /// Monte Carlo p: (1 + null values that reach it) / (1 + null values).
  double p(Eigen::Index place, double root) const;
};

/// `roots`: places x surrogates. Values below `worthwhile` could not be accepted and do not count for the largest;
/// `least_spread` stands for places that explain nothing on any surrogate.
MaxNull maxNull(const Eigen::MatrixXd& roots, double worthwhile, double least_spread);

/// An explanation that is compared in one pass of the selection.
struct SelectionTrial {
  Eigen::Index place = 0;  ///< row of the null
  double root = 0.0;       ///< of the square that it explains, in the null's units
  std::string name;
  std::string objection;  ///< why it may not be accepted; empty: only the null is left to pass
};

/// A residual that explanations are selected for: of the forces, of the pose.
class SelectionProblem {
 public:
  virtual ~SelectionProblem() = default;
  /// Compares all explanations that are not in the model yet. Best first; empty: nothing is left to explain.
  virtual std::vector<SelectionTrial> compare() = 0;
  /// What surrogates of the model as it stands explain at the places that compare() spoke of.
  virtual MaxNull null() = 0;
  /// Puts compare()'s trial k into the model, refits, and takes out what it makes superfluous. False: nothing was
  /// gained.
  virtual bool accept(std::size_t k, const MaxNull& null, double p) = 0;
};

/// Adds explanations one after the other: in every pass the best one that nothing speaks against and that beats the
/// null.
/// Returns how many passes added one; `rejected` says why the last pass did not.
int selectForward(SelectionProblem& problem, int most, double largest_p, std::vector<std::string>& rejected);

}  // namespace knee_robot::tracing
