#pragma once

#include <vector>

#include "knee_robot/mechanism/leg_motion.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {

/// The platform's motion along a recording, one entry per sample.
struct MotionPath {
  std::vector<mechanism::Motion> motion;  ///< empty without a platform; the last good one where the pose is not known
  std::vector<char> pose_known;           ///< 0 where forward kinematics failed
  std::vector<double> condition;          ///< of the Jacobian (m, rad); infinite where the pose is not known
  std::vector<char> uncertain;  ///< masked: near a singularity, or of an unknown assembly mode; empty: nowhere
  bool coupled = false;         ///< false: bench axes, each of which is an experiment of its own
};

/// Row `sample` of a matrix of up to four actuators, filled up with zeros.
mechanism::Vector4 actuatorRow(const Eigen::MatrixXd& values, int sample);

}  // namespace knee_robot::identification
