#pragma once

#include <Eigen/Core>
#include <mutex>
#include <vector>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::tracing {

struct EffectInput;

/// How much longer legs are than their encoders say, with first and second derivatives; samples x actuators.
struct LengthPath {
  LengthPath(Eigen::Index samples, Eigen::Index actuators)
      : length_m(Eigen::MatrixXd::Zero(samples, actuators)), rate(length_m), acceleration(length_m) {}
  Eigen::MatrixXd length_m, rate, acceleration;
};

/// Where legs are longer by less, everywhere, what lies beyond the load's first order is left out.
constexpr double kFirstOrder_m = 1e-3;

/// A change of the load as it is, or none where it is no force of any machine: by masses of a search's first fits the
/// platform may fall off its springs, and what is no number ends a whole search.
Eigen::MatrixXd forceOrNone(Eigen::MatrixXd change_N);

/// How the load of the actuators changes where legs are longer than their encoders say, to first order, by the current
/// model: the platform stands, and moves, elsewhere, so that one leg changes the load of all. Calculated when somebody
/// asks, once; safe in several threads.
class LengthResponse {
 public:
  /// At one moment; row: actuator, column: leg.
  struct Knot {
    bool known = false;                                         ///< the pose is
    mechanism::Matrix4 stiffness = mechanism::Matrix4::Zero();  ///< load per length, N/m
    mechanism::Matrix4 mass = mechanism::Matrix4::Zero();       ///< load per length's acceleration, kg
  };
  /// At a sample of the recording: between knots in proportion to time.
  Knot at(const EffectInput& input, int sample);
  /// What the whole model's load changes along such a path beyond what the knots say, N, samples x legs: millimetres
  /// bend what the platform hangs on, and rates count as well. At the knots; between them in proportion to time.
  Eigen::MatrixXd beyondFirstOrder(const EffectInput& input, const LengthPath& longer);

 private:
  void calculate(const EffectInput& input);

  std::once_flag once_;
  int stride_ = 1;  ///< samples from knot to knot
  std::vector<Knot> knots_;
};

}  // namespace knee_robot::tracing
