#pragma once

#include "knee_robot/dynamics/model.h"
#include "knee_robot/identification/motion_path.h"

namespace knee_robot {

/// Force (N) that the model predicts along a recorded motion, one row per sample of `signals` and one column per actuator, from
/// motion and time alone. Every entry is finite: where the pose is not known, the last known force goes on.
Eigen::MatrixXd predictForce(const Model& model, const Robot& robot, const Signals& signals, const MotionPath& motion);

}  // namespace knee_robot
