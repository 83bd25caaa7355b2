#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/identification/identify.h"

namespace knee_robot::identification {

/// Error of the physically consistent fit with one strength of the prior. Errors are mean squares in units of the
/// noise.
struct PhysicalPoint {
  double strength = 0.0;        ///< of the prior: information of the data at which prior and data count alike
  double supported = 0.0;       ///< rigid directions and offsets that the data decide
  double held_back = 0.0;       ///< on blocks of the training data that were left out in turn
  double beyond_best = 0.0;     ///< held_back minus that of the best strength
  double standard_error = 0.0;  ///< of beyond_best
};

/// One body: as it was fitted, and by the URDF.
struct PhysicalBody {
  std::string name;  ///< of the link; in a chain the link that the joint moves, with all that is fixed to it
  dynamics::LinkInertia fitted, prior;
  double moved = 0.0;  ///< size of the change from the prior in the prior's own metric (0: none; 1: as large as it)
};

/// Full parameters that a robot can have: positive masses, possible inertia tensors, friction and rotor inertia not
/// negative.
struct PhysicalFit {
  dynamics::Model model;           ///< like the base fit's, with these values; no base combinations
  dynamics::RobotInertia inertia;  ///< of the parallel robot's nine links and its rotors
  std::vector<PhysicalBody> bodies;
  double strength = 0.0;
  double supported = 0.0;
  bool optimal =
      false;  ///< the solver ended at the optimum of the (convex) problem, not merely at the boundary of the possible
  std::vector<PhysicalPoint> curve;
};

/// Fits physically consistent parameters to the equations of a base fit, with the same noise, outlier weights and
/// friction widths.
/// The prior (the robot's URDF) decides where the data are silent. Its strength is chosen as the rank is: the strongest
/// one whose error on left-out blocks of the training data is within one standard error of the best. Offsets have a
/// prior of zero, of a size of a tenth of the actuator's rms force; friction and rotor have none.
PhysicalFit fitPhysical(const mechanism::Robot& robot, const Identification& base, const dynamics::RobotInertia& prior);
/// The same of a chain, by its own URDF.
PhysicalFit fitPhysicalChain(const mechanism::Robot& robot, const Identification& base);

}  // namespace knee_robot::identification
