#pragma once

#include <Eigen/Core>
#include <vector>

#include "instant_slopes.h"
#include "knee_robot/excitation/excitation.h"

namespace knee_robot::excitation {

/// A cost of the eigenvalues l_1 >= l_2 >= ... of the scaled Gram matrix D W^T W D of an observation matrix W (4 rows
/// an instant), by r directions. Gram matrices lose half of the digits: good as long as k stays below 1e6.
///
/// Condition: columns scaled to unit norm, log k = log(s_1 / s_r) with s = sqrt(l), smoothed with an exponent p:
///     (1/2p) [log sum_{i<=r} l_i^p + log sum_{i<=r} l_i^-p]
/// which bounds log k from above and approaches it as p grows. Where eigenvalues meet (an optimum of k makes them meet)
/// log k has a kink, this has none. p = 0: log k itself.
///
/// Determinant: columns scaled by fixed numbers, -(1/2r) sum_{i<=r} log l_i: D-optimality on the r strongest
/// directions.
class SpectralCost {
 public:
  /// `fixed_scale`: factors of the 112 columns for Determinant; not used otherwise.
  SpectralCost(const std::vector<PaperRegressor>& observations, int directions, ExcitationCriterion criterion,
               double exponent, const Eigen::VectorXd& fixed_scale);

  double value() const { return value_; }
  /// d(value)/d(observations[t]), contracted as value's change = sum of elements of (this * change).
  PaperRegressor gradient(const PaperRegressor& observation) const { return observation * slope_; }

 private:
  double value_ = 0.0;
  Eigen::MatrixXd slope_;  ///< 112 x 112
};

/// 1 / norm of each column of the stacked observations; 0 for empty ones.
Eigen::VectorXd columnScales(const std::vector<PaperRegressor>& observations);

/// Condition numbers by singular value decomposition, columns scaled and raw.
std::vector<ConditionAt> conditionsOf(const std::vector<PaperRegressor>& observations,
                                      const std::vector<int>& directions);

}  // namespace knee_robot::excitation
