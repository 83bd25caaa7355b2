#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/accuracy.h"

namespace knee_robot::identification {

/// Why recordings that took no part in the fit may not be of the machine as it was trained: forces of another sign or
/// unit, of another robot. One sentence a recording, none for a sound one. `predictions` belong to `observations`, in
/// order; `trained`: what the same model leaves of training.
std::vector<std::string> doubtsAboutValidation(const mechanism::Robot& robot,
                                               const std::vector<Observation>& observations,
                                               const std::vector<Prediction>& predictions, const Accuracy& trained);

/// Refusal where an actuator moves and all of its rows have the same force: nothing can be compared with that.
void requireForces(const mechanism::Robot& robot, const std::vector<Observation>& validation,
                   const ObservationOptions& options);

}  // namespace knee_robot::identification
