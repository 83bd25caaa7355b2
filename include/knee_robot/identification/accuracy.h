#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

/// How far predictions are from commanded forces; one entry per actuator (docs/contract.md, section 3). Samples are those
/// that are compared (Observation::judged).
struct Accuracy {
  Eigen::VectorXd rms_N;         ///< all samples, both sides low-passed
  Eigen::VectorXd rms_moving_N;  ///< the same, samples at which every axis moves; nan when there is none
  /// The same, samples at which the axis itself rests, once it has moved and the pose is usable; nan when there is none.
  Eigen::VectorXd rms_resting_N;
  /// All samples from the first movement of each axis on, both sides low-passed: before it, no recording tells what
  /// friction holds. Nan of an axis that never moves.
  Eigen::VectorXd rms_since_moved_N;
  Eigen::VectorXd rms_raw_N;      ///< rows of the recording, neither side filtered: the full band
  Eigen::VectorXd raw_percent;    ///< 100 rms_raw_N / rms(rows)
  Eigen::VectorXd rms_percent;    ///< 100 rms_N / rms(measured)
  Eigen::VectorXd range_percent;  ///< 100 rms_N / range(measured)
  Eigen::VectorXd max_N;          ///< largest error, both sides low-passed
  /// 100 rms(error) / rms(measured) over all actuators together, as publications on serial arms do.
  double togetherPercent() const;
  int samples = 0;
  int moving_samples = 0;
};

/// Prediction of one recording, on the grid and for its rows.
struct Prediction {
  Eigen::MatrixXd force_N;           ///< per sample of the grid
  Eigen::MatrixXd force_filtered_N;  ///< low-passed as the measured side is
  Eigen::MatrixXd row_force_N;  ///< per row of the recording, in the middle of the interval in which its command holds
};

/// Brings a predicted force on the grid to the three forms.
Prediction makePrediction(const Observation& observation, Eigen::MatrixXd force_N, double cutoff_hz);

/// Over several recordings together. `predictions` belong to `observations`, in order; both may not be empty.
Accuracy accuracyOf(const std::vector<Observation>& observations, const std::vector<Prediction>& predictions);

}  // namespace knee_robot::identification
