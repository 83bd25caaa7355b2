#pragma once

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

struct LegSprings {
  mechanism::Vector4 stiffness_N_per_m;
  double damping_ratio = 0.1;  ///< of each with what it moves
};

/// Change of the load (N, samples x legs) where each leg ends in a spring, between its encoder and the platform, that
/// slow loads would make longer by `longer_m` (samples x legs). The platform swings about the path that the encoders
/// show: mass and gravity by the model's derivatives there, springs (per leg), integrated from rest. Faster than its resonance (some 5 Hz with soft screws) it does not follow. Zero where the pose is unknown.
Eigen::MatrixXd changeBehindSprings(const EffectInput& input, const LegSprings& springs,
                                    const Eigen::MatrixXd& longer_m);

}  // namespace knee_robot::tracing
