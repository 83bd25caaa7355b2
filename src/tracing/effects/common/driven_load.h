#pragma once

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// Joint between motor and screw: elastic, with play. The encoder and the rotor are on the motor's side, friction is on
/// the screw's.
struct DriveJoint {
  double stiffness_N_per_m = 1e7;
  double half_gap_m = 0.0;
};

/// What replacing the measured (motor's) motion by the screw's changes in the model's force on one actuator, N, one
/// entry a sample. The screw's motion is integrated quasi-statically from the measured one: it stands while the joint's
/// force less the load stays within dry friction, and slides otherwise. Its dry and viscous friction and the inertia
/// that it moves then take the screw's motion instead of the measured one; the rotor keeps the measured one.
/// Deflections are millimetres, so that the load itself is taken at the measured pose, and what this actuator's
/// deflection does to the other legs is left out.
Eigen::VectorXd changeByJoint(const EffectInput& input, int actuator, const DriveJoint& joint);

}  // namespace knee_robot::tracing
