#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// What repeats with a screw's turn: a sine and a cosine per recording, because homing does not know the turn's phase.
/// The first shape parameter is the period (m).
class Ripple : public Candidate {
 public:
  /// A chain's gears ripple at orders of a period, with a phase that the joint keeps: gear_ripple.
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain && Candidate::worksOn(robot); }
  bool transfers() const override { return false; }
  bool periodic() const override { return true; }
  int mostOnOneActuator() const override { return 3; }  // lead, balls, motor
  double leastFloors() const override { return 1.0; }   // bristles at rest look like a short one
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;
  std::vector<Coefficient> coefficients(const EffectInput& input) const override;
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;
  /// The mean, times the share of it that training recordings support by agreeing: with phases at random, the square of
  /// the mean of n is as large as their spread over n. One recording cannot tell.
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override;
  Eigen::VectorXd atHome(const Eigen::VectorXd& coefficients, const std::vector<int>& same_home) const override;

 protected:
  /// Unit of sine and cosine, as names of coefficients end.
  virtual std::string unit() const = 0;
  /// What ripples, one entry a sample.
  virtual Eigen::VectorXd rippling(const EffectInput& input, int actuator, const std::vector<double>& shape) const = 0;
};

}  // namespace knee_robot::tracing
