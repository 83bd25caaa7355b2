#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::tracing {

/// Poses of one row each (Xm, Zm in m, theta, psi in rad), nan where forward kinematics found none.
struct PosePath {
  Eigen::MatrixXd pose;       ///< rows x 4
  Eigen::VectorXd condition;  ///< upper bound of the Jacobian's condition number (m, rad); nan like the pose
  int unknown = 0;            ///< rows without pose
};
/// Forward kinematics row by row, each started from the pose before; the first from the level platform above the base.
PosePath posesOf(const mechanism::Mechanism& mechanism, const Eigen::MatrixXd& lengths_m);

/// How the camera's pose becomes that of forward kinematics. Both are fixed over the recording:
///   (x, z)_robot = turn(rotation) (x, z)_camera + shift, theta_robot = theta_camera + rotation   (frame: a rigid motion in XZ)
///   psi_robot = psi_camera + plate                                                               (how the markers sit)
struct CameraAlignment {
  bool known = false;
  double delay_s = 0.0;  ///< the camera shows the pose this much later than the encoders; 0 when not determined
  bool delay_known = false;
  double correlation = 0.0;   ///< of the velocities at that delay
  double rotation_rad = 0.0;  ///< about Y
  double shift_x_m = 0.0, shift_z_m = 0.0;
  double plate_rad = 0.0;  ///< about the platform's normal
  int rows = 0;            ///< rows that the rigid fit rests on
};

/// What 1 rad is worth beside 1 m when poses are compared: a platform's radius.
inline constexpr double kRadianLength_m = 0.3;

/// The camera's pose in the robot's frame.
mechanism::Pose cameraInRobot(const CameraAlignment& alignment, const mechanism::Pose& camera);
/// Distance of two poses in m, angles weighed with kRadianLength_m.
double poseDistance(const mechanism::Pose& a, const mechanism::Pose& b);

/// The camera's poses (rows x 4, its own frame) at the encoders' times: `delay_s` later by the camera's clock, by
/// straight lines between pictures that are at most 50 ms apart; nan elsewhere.
Eigen::MatrixXd cameraAtRows(const recording::Recording& recording, double delay_s);

/// Delay by cross-correlation of the velocities (all four coordinates, within +-0.5 s), then a rigid fit by least
/// squares, in turns.
/// Both leave out rows with a condition above `condition_max`, and rows far from the rest (beyond five times the median
/// distance of a first fit for the delay, three times for the fit). `known` is false when fewer than 20 rows can be
/// used.
CameraAlignment alignCamera(const recording::Recording& recording, const PosePath& measured, double condition_max);

/// The pose with these lengths that Newton reaches from the camera's (in the robot's frame), when it is another one
/// than `measured`, more than 1 mm away and nearer to the camera's: the platform has passed a singularity, which
/// encoders cannot see.
bool otherSolution(const mechanism::Mechanism& mechanism, const mechanism::Lengths& lengths,
                   const mechanism::Pose& camera, const mechanism::Pose& measured, mechanism::Pose& other);

}  // namespace knee_robot::tracing
