#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// The low-pass of the positions from which a model is fitted.
struct MotionBand {
  double cutoff_hz = 0.0;  ///< 0: motionCutoff's
  std::string sentence;    ///< for the report; empty where nothing was chosen
};

/// Chooses a wider low-pass than motionCutoff's, where the encoders allow twice that or more: near rest friction
/// follows motions of micrometres that are faster than what the fit's cut-off leaves of the forces, and a bristle or a
/// stop that misses them holds another force. A model is fitted from each; a wider one is taken where it leaves a
/// twentieth less of the training recordings, both sides low-passed. `training`: observed with `options`.
MotionBand chooseMotionBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<recording::Recording>& recordings, std::vector<Observation> training,
                            const ObservationOptions& options);

}  // namespace knee_robot::identification
