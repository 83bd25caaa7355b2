#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/tracing/pose_alignment.h"

namespace knee_robot::report {

/// Figures of one error over the rows where it is known.
struct ErrorFigures {
  int rows = 0;
  double max_abs = 0.0, rms = 0.0, mean = 0.0;  ///< nan without rows
  double time_of_max_s = 0.0;
};
ErrorFigures errorFigures(const std::vector<double>& time_s, const Eigen::VectorXd& error);

/// Camera against forward kinematics.
struct CameraComparison {
  tracing::CameraAlignment alignment;
  Eigen::MatrixXd pose;             ///< of the camera, aligned in time and frame; rows x 4, nan without picture
  ErrorFigures error[4];            ///< camera minus forward kinematics, m and rad
  ErrorFigures error_regular[4];    ///< only where the condition is below the limit and the solution is the camera's
  ErrorFigures reference_error[4];  ///< camera minus pose of the reference
  /// Rows in which the same lengths have another pose, more than 1 mm away and nearer to the camera's: the platform has
  /// passed a singularity, which encoders cannot see.
  int other_solution = 0;
  double other_from_s = 0.0, other_to_s = 0.0;  ///< first and last such row
  ErrorFigures error_nearest[4];                ///< camera minus the nearer of the two poses
};
/// Aligns the camera (tracing/pose_alignment.h) and compares. alignment.known is false when there are too few rows.
CameraComparison compareCamera(const mechanism::Mechanism& mechanism, const recording::Recording& recording,
                               const tracing::PosePath& measured, const Eigen::MatrixXd& reference,
                               double condition_max);

/// Everything that compare's files say.
struct CompareResults {
  std::string command_line, robot_path;
  recording::Recording recording;
  std::vector<ErrorFigures> actuators;  ///< measured minus reference, m
  bool has_pose = false;                ///< not for independent axes
  double condition_max = 0.0;           ///< above it rows count as near a singularity
  tracing::PosePath measured, reference;
  ErrorFigures pose[4];  ///< pose of the measured lengths minus pose of the reference, m and rad
  bool has_camera = false;
  CameraComparison camera;
  std::vector<std::string> notes;
};

/// Compares. InputError when the recording has no reference columns or another number of actuators than the robot;
/// Refusal when forward kinematics finds no pose for any row.
CompareResults compare(const mechanism::Robot& robot, const recording::Recording& recording, double condition_max);

/// The paper's figures (text to Figs. 15 and 16): legs 1 to 3 below 1 mm, leg 4 above 2 mm; X 30 mm, Z 10 mm, theta 2.5
/// deg, psi 7 deg. Largest errors, in mm and deg.
struct PaperFigure {
  const char* quantity;
  const char* unit;
  const char* paper;
};
extern const PaperFigure kPaperFigures[8];

/// report.json: figures, alignments, paper's figures, notes. SI.
std::string compareJson(const CompareResults& results);
/// What the program prints.
std::string compareSummary(const CompareResults& results);
/// Writes report.json, report.html, actuators.svg and pose.svg into `folder` (made when missing).
void writeCompareFiles(const CompareResults& results, const std::string& folder);

}  // namespace knee_robot::report
