#pragma once

#include <vector>

#include "knee_robot/identification/identify.h"

namespace knee_robot::identification {

/// A model applied to a set of recordings.
struct Applied {
  std::vector<Prediction> predictions;  ///< one per recording
  Accuracy accuracy;                    ///< over all of them together
};

/// Predictions of `model` for all `observations` (at least one).
Applied applyModel(const dynamics::Model& model, const mechanism::Robot& robot,
                   const std::vector<Observation>& observations, double cutoff_hz);

/// For every point of the rank curve: rms of the moving samples (N, per actuator) with the least-squares parameters of
/// that rank. Coulomb columns of `observations` must be set to the model's widths.
std::vector<Eigen::VectorXd> errorAgainstRank(const Identification& identification,
                                              const std::vector<Observation>& observations, double cutoff_hz);

}  // namespace knee_robot::identification
