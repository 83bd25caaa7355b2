#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knee_robot/identification/identify.h"

namespace knee_robot::identification {

/// How positions are smoothed from which a model is fitted.
struct MotionBand {
  double cutoff_hz = 0.0;   ///< low-pass; 0: motionCutoff's
  double taut_steps = 0.0;  ///< ObservationOptions::taut_steps
  std::string sentence;     ///< for the report; empty where nothing was chosen
  /// What was fitted from positions smoothed so, without standard errors; null: nothing was tried.
  std::shared_ptr<const Identification> fit;
};

/// Chooses a wider low-pass than motionCutoff's, where the encoders allow twice that or more: near rest friction
/// follows motions of micrometres that are faster than what the fit's cut-off leaves of the forces, and a bristle or a
/// stop that misses them holds another force. Then, where rounding shows in slow velocities, whether smooth laws follow
/// the shortest line within an encoder's steps: they read every tremble as motion. A model is fitted from each; one is
/// taken where it leaves a twentieth less of the training recordings, both sides low-passed. `training`: observed with
/// `options`.
MotionBand chooseMotionBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<recording::Recording>& recordings, std::vector<Observation> training,
                            const ObservationOptions& options);

}  // namespace knee_robot::identification
