#pragma once

#include <optional>

#include "knee_robot/trajectory/excitation.h"
#include "observation_condition.h"

namespace knee_robot {

/// The instants at which series of one shape are looked at, with the basis there.
struct SampledBasis {
  SampledBasis(const SeriesShape& shape, double rate_hz);
  std::vector<SeriesBasis> at;
};

/// How much of the limits an instant uses; 1 is exactly at a limit.
struct LimitUse {
  double worst = 0.0;    ///< largest ratio of value to limit
  double penalty = 0.0;  ///< sum of squared excesses beyond 1
};

/// The optimisation problem of planExcitation: actuator series -> log k and use of limits, with gradients. Constant after
/// construction, so that several threads may share it.
class ExcitationProblem {
 public:
  /// `robot` has the limits to be kept; `centre` is the pose around which the variables are expressed.
  ExcitationProblem(const Robot& robot, const SeriesShape& shape, int directions, bool twin_legs, const Pose& centre);

  /// 4 for the centre, then 4 a column of coefficients; about 0.1 m and 0.3 rad a unit.
  int variables() const { return 4 + 8 * shape_.harmonics; }
  FourierSeries series(const Eigen::VectorXd& variables) const;

  /// Log of k at the stated directions, plus `penalty_weight` times the penalty. Nothing when the mechanism cannot follow.
  /// `gradient` may be null.
  std::optional<double> cost(const Eigen::VectorXd& variables, double penalty_weight, Eigen::VectorXd* gradient) const;

  /// Largest use of any limit along the series; infinite when the mechanism cannot follow it.
  double worstUse(const FourierSeries& series) const;

  /// The stacked observations; nothing when the mechanism cannot follow.
  std::optional<std::vector<PaperRegressor>> observations(const FourierSeries& series) const;

  /// The series with all coefficients times the largest factor up to `largest` that keeps the limits, its centre drawn towards
  /// the middle when that alone is beyond them; nothing when no factor does.
  std::optional<Eigen::VectorXd> scaledToLimits(Eigen::VectorXd variables, double largest) const;

 private:
  struct Instant;
  bool evaluate(const SeriesPoint& point, const Pose& guess, bool with_limits, Instant& out) const;
  void addGradient(const Instant& at, const SeriesPoint& point, const SeriesBasis& basis,
                   const PaperRegressor& direction, double penalty_weight,
                   Eigen::Matrix<double, 4, Eigen::Dynamic>& gradient) const;
  LimitUse limitUse(const SeriesPoint& point, const Motion& motion) const;
  Pose startPose(const FourierSeries& series, bool& ok) const;

  Robot robot_;
  SeriesShape shape_;
  int directions_;
  Lengths centre_lengths_;
  Pose centre_pose_;
  Matrix4
      unit_;  ///< actuator change of one unit of each variable: dq/dx times units, legs 2 and 3 tied if they are twins
  SampledBasis coarse_, fine_;
};

}  // namespace knee_robot
