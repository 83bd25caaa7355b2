#pragma once

#include <vector>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

// A friction that an effect adds need not build up near rest as the actuator's own does: what rubs in a loaded nut is
// another interface than what rubs in a seal. Such an effect has one more shape parameter, the last: 0 follows the law
// of the actuator, any other is the speed of a smooth law of its own, tanh(v / speed).

ShapeParameter restLawParameter();
/// Every shape with the actuator's law, and with a smooth one.
std::vector<std::vector<double>> withRestLaws(const std::vector<std::vector<double>>& grid);
/// The same shape, smooth below a lower and below a higher speed; none where it follows the actuator's law.
std::vector<std::vector<double>> besideRestLaw(const std::vector<double>& shape, double step);
/// The share of such a friction in [-1, 1] along a recording, by the last entry of the shape.
Eigen::VectorXd rubbingShare(const EffectInput& input, int actuator, const std::vector<double>& shape);

}  // namespace knee_robot::tracing
