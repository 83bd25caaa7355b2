#pragma once

#include "knee_robot/dynamics/parameters.h"

namespace knee_robot::dynamics {

/// Pseudo-inertia matrix of a body about its link frame's origin (Wensing, Kim and Slotine 2018):
///
///     [ integral of r r^T dm   m c ]
///     [ (m c)^T                m   ]        kg m^2, kg m, kg
///
/// Linear in the ten parameters, and positive definite exactly when they belong to a body of positive mass whose
/// principal moments satisfy the triangle inequalities strictly.
mechanism::Matrix4 pseudoInertia(const LinkParameters& parameters);

/// Inverse of pseudoInertia; only the upper triangle is read.
LinkParameters parametersOfPseudoInertia(const mechanism::Matrix4& pseudo_inertia);

}  // namespace knee_robot::dynamics
