#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/markers.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::tracing {

/// A motion capture brought beside a recording: its time and its frame.
struct RegisteredCapture {
  Eigen::MatrixXd pose;      ///< rows of the recording x 4 (Xm, Zm, theta, psi), robot's frame; nan without picture
  double delay_s = 0.0;      ///< capture's time minus recording's time of the same instant
  double correlation = 0.0;  ///< of the speeds at that delay
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  ///< capture's frame to robot's
  double rms_m = 0.0;  ///< of the platform's joints after registration, where forward kinematics is regular
  double out_of_plane_m = 0.0,
         tilt_rad = 0.0;  ///< rms of what the mechanism cannot do: along Y, and about the turned X
  int pictures = 0;       ///< rows with a pose
  std::vector<std::string> notes;
};

/// Time alignment by cross-correlation of the platform's speeds (linear and angular, which no frame changes) over all
/// delays with enough overlap, then frame alignment by rigid registration (Umeyama) of the platform's four joints
/// between capture and forward kinematics, where those are regular, without rows beyond three times the median
/// distance. InputError for a robot without platform; Refusal when the speeds do not correlate or too few rows overlap.
RegisteredCapture registerCapture(const mechanism::Robot& robot, const recording::Recording& recording,
                                  const recording::MarkerPoses& capture, double condition_max);

}  // namespace knee_robot::tracing
