#pragma once

#include "excitation_problem.h"

namespace knee_robot::excitation {

/// What planExcitation searches in.
struct ExcitationSetup {
  mechanism::Robot limited;  ///< the robot with the options' limits where they are stricter than its own
  ExcitationProblem
      problem;  ///< with limits a little inside of these, so that they hold between the instants looked at
};

/// InputError: options out of range, or a robot without a platform. Refusal: no pose has room for any motion.
ExcitationSetup setUpExcitation(const mechanism::Robot& robot, const ExcitationOptions& options);

}  // namespace knee_robot::excitation
