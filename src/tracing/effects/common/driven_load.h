#pragma once

#include <vector>

#include "knee_robot/tracing/candidate.h"
#include "knee_robot/tracing/effect_input.h"
#include "screw_behind_joint.h"

namespace knee_robot::tracing {

/// Shape parameter of effects that have such a joint.
ShapeParameter frictionBeyondParameter();
/// Every shape with all friction on the screw's side, and with a part of it.
std::vector<std::vector<double>> withFrictionBeyond(const std::vector<std::vector<double>>& grid);
/// The same joint (first entry) a little softer or wider and the other way, and another share beyond it (second entry).
std::vector<std::vector<double>> besideJoint(const std::vector<double>& shape, double step,
                                             const std::vector<ShapeParameter>& limits);

/// What replacing the measured (motor's) motion by the screw's changes in the model's force on one actuator, N, one
/// entry a sample. The screw's motion is integrated quasi-statically from the measured one: it goes to where the joint's
/// force balances the load, viscous friction, and dry friction by the actuator's law near rest along the screw's own way.
/// Friction of its side and the inertia that it moves then take the screw's motion instead of the measured one; the
/// rotor keeps the measured one. For play of a few millimetres: the load is taken at the measured pose, and what the play
/// does to the other legs is left out (yielding_coupling.h has both).
Eigen::VectorXd changeByJoint(const EffectInput& input, int actuator, const DriveJoint& joint);

}  // namespace knee_robot::tracing
