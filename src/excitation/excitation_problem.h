#pragma once

#include <optional>

#include "knee_robot/dynamics/robot_inertia.h"
#include "spectral_cost.h"

namespace knee_robot::excitation {

/// The instants at which series of one shape are looked at, with the basis there.
struct SampledBasis {
  SampledBasis(const SeriesShape& shape, double rate_hz);
  std::vector<SeriesBasis> at;
};

/// What an excitation is sought for.
struct ExcitationTask {
  mechanism::Robot robot;  ///< with the limits to be kept
  SeriesShape shape;
  int directions = 51;
  ExcitationCriterion criterion = ExcitationCriterion::Condition;
  mechanism::Vector4 noise_N = mechanism::Vector4::Ones();
  bool twin_legs = false;
  std::optional<ExpectedLoad> load;  ///< none: forces are not limited
  dynamics::CoulombWidth width{1e-3,
                               3e-3};  ///< smoothed signs, so that slopes exist; narrow beside the motion's velocities
  Eigen::VectorXd fixed_scale;         ///< of the columns, for Determinant
};

/// The optimisation problem of planExcitation: variables -> criterion and use of limits, with exact gradients. Constant
/// after construction, so that several threads may share it.
class ExcitationProblem {
 public:
  /// `centre` is the pose around which the variables are expressed.
  ExcitationProblem(ExcitationTask task, const mechanism::Pose& centre);

  /// 4 for the centre, then 4 a column of coefficients; about 0.1 m and 0.3 rad a unit.
  int variables() const { return 4 + 8 * task_.shape.harmonics; }
  FourierSeries series(const Eigen::VectorXd& variables) const;
  const ExcitationTask& task() const { return task_; }
  void setFixedScale(const Eigen::VectorXd& scale) { task_.fixed_scale = scale; }

  /// Everything at one set of variables. Slopes are filled only when they are asked for.
  struct Evaluation {
    Eigen::VectorXd variables;
    double cost = 0.0;
    Eigen::VectorXd limits;  ///< use - 1 of every limit in every stretch of time: kept when not positive
    Eigen::VectorXd cost_gradient;
    Eigen::MatrixXd limit_gradients;  ///< variables x limits
    bool has_slopes = false;
  };
  /// `exponent`: see SpectralCost. False when the mechanism cannot follow the series.
  bool evaluate(const Eigen::VectorXd& variables, double exponent, bool with_slopes, Evaluation& out) const;

  /// Each quantity's largest use is taken over stretches of a quarter of the highest harmonic's period, then one entry
  /// an actuator for the rms force.
  int limits() const { return kQuantities * stretches_ + mechanism::kLegs; }

  /// Largest use of any limit along the series, at three times as many instants as evaluate() looks at; infinite when
  /// the mechanism cannot follow it. Stops looking beyond `enough`.
  double worstUse(const Eigen::VectorXd& variables, double enough) const;

  /// The observations, divided by the noise; nothing when the mechanism cannot follow. At evaluate()'s instants with
  /// smoothed signs, or at the streamed points with the signs themselves.
  std::optional<std::vector<PaperRegressor>> observations(const FourierSeries& series) const;
  std::optional<std::vector<PaperRegressor>> observationsAsPlayed(const FourierSeries& series) const;

  /// The series with all coefficients times the largest factor up to `largest` that keeps the limits, its centre drawn
  /// towards the middle when that alone is beyond them; nothing when no factor does.
  std::optional<Eigen::VectorXd> scaledToLimits(Eigen::VectorXd variables, double largest) const;

 private:
  static constexpr int kQuantities =
      6 * mechanism::kLegs;  ///< lengths, velocities, accelerations, forces; 7 angles and the condition
  using Uses = Eigen::Matrix<double, kQuantities, 1>;
  using UseSlopes = Eigen::Matrix<double, kQuantities, 3 * mechanism::kLegs>;
  struct Instant {
    SeriesPoint point;
    mechanism::Motion motion;
    PaperRegressor regressor;
    mechanism::Vector4 force = mechanism::Vector4::Zero();
    Uses uses;
  };
  bool visit(const SeriesPoint& point, const mechanism::Pose& guess, const dynamics::CoulombWidth& width,
             Instant& out) const;
  void fillUses(Instant& instant) const;
  void slopesOfUses(const Instant& instant, const InstantSlopes& slopes, UseSlopes& out) const;
  void addSlopes(const std::vector<Instant>& instants, const SpectralCost& cost, Evaluation& out) const;
  std::optional<std::vector<PaperRegressor>> observationsAt(const FourierSeries& series, const SampledBasis& basis,
                                                            const dynamics::CoulombWidth& width) const;
  mechanism::Pose startPose(const FourierSeries& series, bool& ok) const;
  int stretchOf(std::size_t instant) const;

  ExcitationTask task_;
  mechanism::Lengths centre_lengths_;
  mechanism::Pose centre_pose_;
  /// Actuator change of one unit of each variable: dq/dx times units, legs 2 and 3 tied if they are twins.
  mechanism::Matrix4 unit_;
  SampledBasis basis_, fine_;
  int stretches_ = 1;
  mechanism::Vector4 peak_force_, rms_force_;  ///< N
  mechanism::JointLimits cosine_room_;         ///< 1 - cos of each joint's limit
  double log_condition_max_ = 0.0;
};

/// The forces' parameters of a robot with a URDF; nothing without one.
std::optional<ExpectedLoad> expectedLoad(const mechanism::Robot& robot, const ExpectedFriction& friction);

}  // namespace knee_robot::excitation
