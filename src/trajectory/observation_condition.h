#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/trajectory/excitation.h"

namespace knee_robot {

using PaperRegressor = Eigen::Matrix<double, kLegs, kPaperParameters>;

/// log(s_1 / s_r) of a column-scaled observation matrix, by way of its Gram matrix: quick, and accurate as long as k stays
/// below 1e6 (its square must stay far from 1e16).
class LogCondition {
 public:
  LogCondition(const std::vector<PaperRegressor>& observations, int directions);

  double value() const { return value_; }
  /// d(value)/d(observations[t]), contracted as value's change = sum of elements of (this * change).
  PaperRegressor gradient(const PaperRegressor& observation) const;

 private:
  struct Direction {
    Eigen::VectorXd unscaled;  ///< y = D v
    Eigen::VectorXd weights;   ///< v_i^2 / S_ii
    double eigenvalue = 0.0;
  };
  Direction largest_, smallest_;
  double value_ = 0.0;
};

/// Condition numbers by singular value decomposition, columns scaled and raw.
std::vector<ConditionAt> conditionsOf(const std::vector<PaperRegressor>& observations,
                                      const std::vector<int>& directions);

}  // namespace knee_robot
