#pragma once

#include <vector>

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {

/// Error of the fit with one strength of the prior. Errors are mean squares in units of the noise.
struct StrengthPoint {
  double strength = 0.0;        ///< of the prior
  int rank = 0;                 ///< directions that the data decide rather than the prior
  double training = 0.0;        ///< on the data that was fitted
  double held_back = 0.0;       ///< on blocks of the training data that were left out in turn
  double beyond_best = 0.0;     ///< held_back minus that of the best strength that is believed
  double standard_error = 0.0;  ///< of beyond_best, over the blocks (same blocks, paired differences)
  double largest_change = 0.0;  ///< of a link from the prior, in units of the prior
  bool believed = true;         ///< that is no more than Prior::largest_change; the strongest pull always is
};

/// Error against strength, and the choice.
struct PriorChoice {
  int rank = 0;
  double strength = 0.0;
  std::vector<StrengthPoint> curve;
};

/// Leaves out one block of the (weighted) equations after the other, at every strength of the prior, weakest last: all
/// directions are fitted, and pulled towards the prior. Training data only.
/// Chosen is the strongest pull within one standard error of the best, among those that leave the links within what the
/// prior believes (Prior::largest_change): held-back blocks of one path have the same unknown forces as the others, and
/// like to see them as bodies that do not exist.
PriorChoice chooseStrength(const Equations& equations, const std::vector<Column>& columns, const std::vector<char>& use,
                           const Prior& prior);

/// The middle, in decades, of the strengths that left-out blocks do not tell from the best: between that and the
/// strongest.
double middleStrength(const PriorChoice& choice);

/// Parameters for every point of a curve of chooseStrength, fitted to all equations.
std::vector<Eigen::VectorXd> parametersByStrength(const Reduction& reduction, const PriorChoice& choice);

/// Directions, friction and rotors included, that the data decide rather than the prior at this strength.
int supportedRank(const Reduction& reduction, double strength);

}  // namespace knee_robot::identification
