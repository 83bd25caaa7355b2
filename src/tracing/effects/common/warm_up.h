#pragma once

#include "knee_robot/dynamics/warming.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// The shape parameter that says what warms the drive up: a number of dynamics::Heat up to `last`.
ShapeParameter heatedByParameter(dynamics::Heat last = dynamics::Heat::Worked);

/// What changes while a drive warms up, from the start of each recording, with a time constant (the first shape
/// parameter), and by the clock, its time in motion or the work of its friction (the second, dynamics::Heat, and the
/// third, HeatSource::viscous_s_per_m; the search begins with the clock, settleHeat decides). Recordings need not begin
/// equally warm: each after the first may begin with more or less than the mean of all, which fades with the same
/// constant.
class WarmUp : public Candidate {
 public:
  static constexpr std::size_t kHeatedBy = 1, kViscousHeat = 2;  ///< of the shape
  static constexpr double kMostViscous_s_per_m = 1000.0;         ///< that the latter may be
  static constexpr double kMostLevelling = 30.0;                 ///< that HeatSource::levels_off may be

  /// Number of the shape parameter that says at which force (N, root mean square) the windings' heat is 1; below 0: they
  /// are not what warms this up.
  virtual int usualForce() const { return -1; }
  /// Number of the shape parameter HeatSource::levels_off; below 0: this is in proportion to the warmth.
  virtual int levelsOff() const { return -1; }

  bool goesWithTime() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override;
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;
  std::vector<Coefficient> coefficients(const EffectInput& input) const override;
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;
  /// A recording that nobody trained on begins as warm as those of training did in the mean.
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override;

 protected:
  /// Names of the coefficients of what changes.
  virtual std::vector<std::string> changes() const = 0;
  /// Force of what changes, per unit of each: samples x changes.
  virtual Eigen::MatrixXd changing(const EffectInput& input, int actuator, const std::vector<double>& shape) const = 0;
};

}  // namespace knee_robot::tracing
