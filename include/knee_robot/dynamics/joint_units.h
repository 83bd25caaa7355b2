#pragma once

#include <string>

#include "knee_robot/mechanism/chain.h"

namespace knee_robot::dynamics {

/// A number's name in a joint's own units, and what one unit of it is worth in those of the actuator in metres and
/// newtons.
struct JointNumber {
  std::string name;     ///< "period_rad" for "period_m"
  double factor = 1.0;  ///< value in the joint's unit = factor * value in metres and newtons
};

/// The name of a number of a revolute joint, whose unit ends it (`period_m`, `damping_N_s_per_m`, `friction_N`), in rad
/// and N m.
JointNumber inJointUnits(const std::string& name, bool revolute);

/// The name and factor that inJointUnits came from.
JointNumber fromJointUnits(const std::string& name, bool revolute);

}  // namespace knee_robot::dynamics
