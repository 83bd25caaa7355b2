#pragma once

#include <Eigen/Core>

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// Motor and screw joined by a spring.
struct YieldingCoupling {
  double stiffness_N_per_m = 1e5;
  double friction_beyond = 1.0;  ///< share of the actuator's friction on the screw's side; the rest is the motor's
  double damping_ratio = 0.1;    ///< of the spring with what it moves
};

/// What such a coupling in one actuator changes in the model's force on all of them, N, samples x axes. Its motor, where
/// the encoder is, goes as measured; the screw goes to where the spring balances load, friction of its side by the
/// actuator's law along its own way, and the inertia of what it moves. By so much the leg is shorter than the encoder
/// says: the platform is elsewhere and swings (by LengthResponse, to first order), which changes what the other legs
/// carry. Where the pose is unknown nothing swings, and nothing reaches the others.
Eigen::MatrixXd changeByCoupling(const EffectInput& input, int actuator, const YieldingCoupling& coupling);

}  // namespace knee_robot::tracing
