#pragma once

#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// Beyond the forces of training by at most this share of their range, on either side, in samples whose pose is not
/// trusted.
inline constexpr double kBeyondTrained = 0.1;

/// The lowest and the highest low-passed force of the usable training samples, per actuator; without a platform
/// nothing, because every position is trusted there.
std::vector<dynamics::TrainedForce> trainedRange(const std::vector<Observation>& training);

/// Brings the forces (N, samples x actuators) at samples with an uncertain pose back to the range of training and its
/// margin. A pose beside a singularity lets a model say anything; no such force was ever seen. Nothing where the range
/// is not known.
void keepWithinTrainedRange(const std::vector<dynamics::TrainedForce>& trained, const MotionPath& motion,
                            Eigen::MatrixXd& force_N);

}  // namespace knee_robot::identification
