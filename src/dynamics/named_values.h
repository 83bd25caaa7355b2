#pragma once

#include "knee_robot/dynamics/model.h"

namespace knee_robot::dynamics {

/// Values, one per parameter of the model, in the order of extendedParameterNames(); 0 where the model lacks one.
ExtendedParameters extendedValues(const Model& model, const std::vector<double>& values);
/// The same of bench axes: column i holds viscous, Coulomb, rotor, offset of axis i.
mechanism::Matrix4 axisValues(const Model& model, const std::vector<double>& values);

}  // namespace knee_robot::dynamics
