#pragma once

#include <Eigen/Core>

namespace knee_robot::tracing {

/// A muscle that answers being stretched fast; lengths in m, or in rad about a joint.
struct Reflex {
  double threshold_per_s = 0.0;  ///< slower stretching does not call it
  double delay_s = 0.0;
  double decay_s = 1.0;  ///< with which it lets go
  double stretch = 1.0;  ///< beyond the threshold, by which its activation grows to 0.63
};

/// Activation a between 0 and 1: da/dt = (1 - a) max(0, rate - threshold) / stretch - a / decay, the rate seen late
/// (Lance's catch of a spastic muscle). `rate_per_s`: of lengthening, at every sample; the muscle was at rest before.
Eigen::VectorXd reflexActivation(const Eigen::VectorXd& rate_per_s, double period_s, const Reflex& reflex);

}  // namespace knee_robot::tracing
