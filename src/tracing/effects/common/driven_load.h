#pragma once

#include <vector>

#include "knee_robot/tracing/candidate.h"
#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// Joint between motor and screw: elastic, with play. The encoder and the rotor are on the motor's side.
struct DriveJoint {
  double stiffness_N_per_m = 1e7;
  double half_gap_m = 0.0;
  double friction_beyond = 1.0;  ///< share of the actuator's friction on the screw's side; the rest is the motor's
};

/// Shape parameter of effects that have such a joint.
ShapeParameter frictionBeyondParameter();
/// Every shape with all friction on the screw's side, and with a part of it.
std::vector<std::vector<double>> withFrictionBeyond(const std::vector<std::vector<double>>& grid);
/// The same joint (first entry) a little softer or wider and the other way, and another share beyond it (last entry).
std::vector<std::vector<double>> besideJoint(const std::vector<double>& shape, double step,
                                             const std::vector<ShapeParameter>& limits);

/// What replacing the measured (motor's) motion by the screw's changes in the model's force on one actuator, N, one
/// entry a sample. The screw's motion is integrated quasi-statically from the measured one: it goes to where the joint's
/// force balances the load, viscous friction, and dry friction by the actuator's law near rest along the screw's own way.
/// Friction of its side and the inertia that it moves then take the screw's motion instead of the measured one; the
/// rotor keeps the measured one. Deflections are millimetres, so that the load itself is taken at the measured pose, and
/// what this actuator's deflection does to the other legs is left out.
Eigen::VectorXd changeByJoint(const EffectInput& input, int actuator, const DriveJoint& joint);

}  // namespace knee_robot::tracing
