#pragma once

#include <string>

#include "knee_robot/dynamics/parameters.h"

namespace knee_robot::dynamics {

/// Mass (kg), centre of mass (m, link frame) and inertia tensor about the centre of mass (kg m^2, axes of the link
/// frame).
struct LinkInertia {
  double mass = 0.0;
  mechanism::Vector3 center = mechanism::Vector3::Zero();
  mechanism::Matrix3 inertia = mechanism::Matrix3::Zero();
};

/// About the link frame's origin, in the order of parameters.h.
LinkParameters toParameters(const LinkInertia& link);
/// Inverse of toParameters. Mass must not be zero.
LinkInertia fromParameters(const LinkParameters& parameters);

/// Principal moments about the centre of mass (kg m^2), smallest first.
mechanism::Vector3 principalMoments(const LinkInertia& link);

/// Why no body can have this inertia: mass not positive, tensor not symmetric, a principal moment negative, or a
/// principal moment larger than the sum of the two others (beyond rounding). Empty when a body can.
std::string inconsistency(const LinkInertia& link);

}  // namespace knee_robot::dynamics
