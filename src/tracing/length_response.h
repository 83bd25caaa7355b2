#pragma once

#include <Eigen/Core>
#include <mutex>
#include <vector>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::tracing {

struct EffectInput;

/// How the load of the actuators changes where legs are longer than their encoders say, to first order, by the current
/// model: the platform stands, and moves, elsewhere, so that one leg changes the load of all. Calculated when somebody
/// asks, once; safe in several threads.
class LengthResponse {
 public:
  /// Change of the load (N, samples) on `actuator` where each leg is longer by its column of `longer_m` (samples x legs),
  /// leg by leg: samples x legs. Zero where the pose is unknown.
  Eigen::MatrixXd onActuator(const EffectInput& input, int actuator, const Eigen::MatrixXd& longer_m);

 private:
  /// At one sample: row: actuator, column: leg.
  struct Knot {
    bool known = false;
    mechanism::Matrix4 stiffness = mechanism::Matrix4::Zero();  ///< N/m
    mechanism::Matrix4 mass = mechanism::Matrix4::Zero();       ///< kg
  };
  void calculate(const EffectInput& input);

  std::once_flag once_;
  int stride_ = 1;  ///< samples from knot to knot
  std::vector<Knot> knots_;
};

}  // namespace knee_robot::tracing
