#pragma once

#include "knee_robot/dynamics/model.h"
#include "knee_robot/identification/accuracy.h"
#include "knee_robot/identification/motion_path.h"

namespace knee_robot::identification {

/// Forces (N), one row per sample of the signals and one column per actuator.
struct PredictedForce {
  Eigen::MatrixXd mean_N;       ///< friction averaged over each sample's interval, as Signals::force_N is
  Eigen::MatrixXd at_sample_N;  ///< friction at the sample itself: what is interpolated to other times
};

/// What the model predicts along a recorded motion, from motion and time alone. Every entry is finite: where the pose
/// is not known, the last known force goes on.
PredictedForce predictForces(const dynamics::Model& model, const mechanism::Robot& robot,
                             const recording::Signals& signals, const MotionPath& motion);

/// Only PredictedForce::at_sample_N.
Eigen::MatrixXd predictForce(const dynamics::Model& model, const mechanism::Robot& robot,
                             const recording::Signals& signals, const MotionPath& motion);

/// Brings predicted forces to the grid, to the low-passed grid and to the recording's rows.
Prediction makePrediction(const Observation& observation, const PredictedForce& force, double cutoff_hz);

}  // namespace knee_robot::identification
