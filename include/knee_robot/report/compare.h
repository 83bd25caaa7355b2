#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot {

/// Figures of one error over the rows where it is known.
struct ErrorFigures {
  int rows = 0;
  double max_abs = 0.0, rms = 0.0, mean = 0.0;  ///< nan without rows
  double time_of_max_s = 0.0;
};
ErrorFigures errorFigures(const std::vector<double>& time_s, const Eigen::VectorXd& error);

/// Poses of one row each (Xm, Zm in m, theta, psi in rad), nan where forward kinematics found none.
struct PosePath {
  Eigen::MatrixXd pose;       ///< rows x 4
  Eigen::VectorXd condition;  ///< upper bound of the Jacobian's condition number (m, rad); nan like the pose
  int unknown = 0;            ///< rows without pose
};
/// Forward kinematics row by row, each started from the pose before; the first from the level platform above the base.
PosePath posesOf(const Mechanism& mechanism, const Eigen::MatrixXd& lengths_m);

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

/// Camera against forward kinematics.
struct CameraComparison {
  CameraAlignment alignment;
  Eigen::MatrixXd pose;             ///< of the camera, aligned in time and frame; rows x 4, nan without picture
  ErrorFigures error[4];            ///< camera minus forward kinematics, m and rad
  ErrorFigures error_regular[4];    ///< only where the condition is below the limit and the solution is the camera's
  ErrorFigures reference_error[4];  ///< camera minus pose of the reference
  /// Rows in which the same lengths have another pose, more than 1 mm away and nearer to the camera's: the platform has passed
  /// a singularity, which encoders cannot see.
  int other_solution = 0;
  double other_from_s = 0.0, other_to_s = 0.0;  ///< first and last such row
  ErrorFigures error_nearest[4];                ///< camera minus the nearer of the two poses
};
/// Delay by cross-correlation of the velocities (all four coordinates, within +-0.5 s), then a rigid fit by least squares.
/// Both leave out rows with a condition above `condition_max`, and rows far from the rest (beyond five times the median distance
/// of a first fit for the delay, three times for the fit). Points and angles are weighed with 0.3 m for 1 rad, a platform's
/// radius.
CameraComparison compareCamera(const Mechanism& mechanism, const Recording& recording, const PosePath& measured,
                               const Eigen::MatrixXd& reference, double condition_max);

/// Everything that compare's files say.
struct CompareResults {
  std::string command_line, robot_path;
  Recording recording;
  std::vector<ErrorFigures> actuators;  ///< measured minus reference, m
  bool has_pose = false;                ///< not for independent axes
  double condition_max = 0.0;           ///< above it rows count as near a singularity
  PosePath measured, reference;
  ErrorFigures pose[4];  ///< pose of the measured lengths minus pose of the reference, m and rad
  bool has_camera = false;
  CameraComparison camera;
  std::vector<std::string> notes;
};

/// Compares. InputError when the recording has no reference columns or another number of actuators than the robot;
/// Refusal when forward kinematics finds no pose for any row.
CompareResults compare(const Robot& robot, const Recording& recording, double condition_max);

/// The paper's figures (text to Figs. 15 and 16): legs 1 to 3 below 1 mm, leg 4 above 2 mm; X 30 mm, Z 10 mm, theta 2.5 deg,
/// psi 7 deg. Largest errors, in mm and deg.
struct PaperFigure {
  const char* quantity;
  const char* unit;
  const char* paper;
};
extern const PaperFigure kPaperFigures[8];

/// report.json: figures, alignments, paper's figures, notes. SI.
std::string compareJson(const CompareResults& results);
/// report.html: tables, Figs. 15 and 16, camera. Self-contained.
std::string compareHtml(const CompareResults& results);
/// What the program prints.
std::string compareSummary(const CompareResults& results);
/// Writes report.json and report.html into `folder` (made when missing).
void writeCompareFiles(const CompareResults& results, const std::string& folder);

}  // namespace knee_robot
