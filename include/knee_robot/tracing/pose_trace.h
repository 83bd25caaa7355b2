#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/tracing/pose_alignment.h"

namespace knee_robot::tracing {

/// The kinds of explanation for a pose that is not the one of forward kinematics.
enum class PoseCause {
  HomeOffset,       ///< one encoder counts from another length than the robot file says
  GeometryError,    ///< one dimension of the mechanism
  TravelClearance,  ///< play of one leg's joints that the direction of travel takes up
  LoadClearance,    ///< play of one leg's joints that the sign of the leg's force takes up
};
/// home_offset, geometry_error, joint_clearance.
const char* nameOf(PoseCause cause);

/// One explanation with one unknown. Offsets and dimensions: what has to be added to the robot file's. Clearances: half
/// the play, never negative: the leg is shorter by it while it pushes (travels outwards), longer while it pulls.
struct PoseHypothesis {
  PoseCause cause = PoseCause::HomeOffset;
  int index = 0;  ///< leg, or dimension in the order of poseDimensions()

  bool operator==(const PoseHypothesis& other) const { return cause == other.cause && index == other.index; }
};
/// R_1_m R_2_m R_3_m ds_m beta_FD_rad beta_FI_rad Rm_1_m Rm_2_m Rm_3_m beta_MD_rad beta_MI_rad.
const std::vector<std::string>& poseDimensions();
/// "home_offset of leg 2", "geometry_error in R_2_m", "joint_clearance of leg 4 (direction of travel)".
std::string textOf(const PoseHypothesis& hypothesis);
/// "length_2_m", "R_2_m", "half_play_4_m": the parameter as report.json names it.
std::string parameterOf(const PoseHypothesis& hypothesis);

/// Robot and camera as the pose model has them.
struct PoseModel {
  CameraAlignment frame;
  std::vector<PoseHypothesis> causes;
  Eigen::VectorXd values;  ///< of the causes, m and rad
};

/// Poses (rows x 4) that the model gives for the measured lengths; nan where `measured` is.
Eigen::MatrixXd modelPoses(const mechanism::Robot& robot, const PoseModel& model, const recording::Recording& recording,
                           const PosePath& measured);

/// Camera minus encoders in the robot's frame, over rows away from singularities and with a trusted picture.
struct PoseErrors {
  int rows = 0;
  mechanism::Vector4 rms = mechanism::Vector4::Zero();  ///< m, m, rad, rad
  mechanism::Vector4 max = mechanism::Vector4::Zero();
};

/// An explanation that was accepted, and what speaks for it.
struct PoseFinding {
  PoseHypothesis hypothesis;
  double value = 0.0, std = 0.0;  ///< std from held-back pieces (jackknife)
  mechanism::Vector4 explained =
      mechanism::Vector4::Zero();  ///< fall of the rms of each coordinate when it is added, m and rad
  double share = 0.0,
         null_share = 0.0;  ///< of the squared, weighed error: explained; by the best on the worst clean surrogate
  double p = 1.0;           ///< against surrogates
  double gain = 0.0, gain_error = 0.0;  ///< held-back pieces: share of the squared error, and its standard error
  /// False for a home offset seen in one training recording only: encoders are set to home anew at every start, so that
  /// it predicts nothing elsewhere. Left out on validation recordings then.
  bool transfers = true;
  std::vector<PoseHypothesis> confusable;  ///< held-back gain as good within its error
};

/// One recording's camera beside the encoders.
struct PoseRecording {
  std::string path, name;
  std::vector<double> time_s;
  CameraAlignment own;                        ///< its own alignment; of validation recordings only for information
  Eigen::MatrixXd before_error, after_error;  ///< rows x 4, robot's frame; nan where not compared
  PoseErrors before, after;
  PoseErrors refitted;  ///< after, with this recording's own frame and delay: what is left if only the camera was moved
  int other_solution = 0;  ///< rows beyond a singularity (masked)
  int near_singular = 0;   ///< masked
  int distrusted = 0;      ///< wrong pictures, far from everything (masked)
};

/// What the cameras taught.
struct PoseTrace {
  bool available = false;  ///< some training recording has enough camera poses
  std::string reason;      ///< when not
  CameraAlignment before;  ///< fixed transform with nothing else, fitted on training
  PoseModel model;
  std::vector<PoseFinding> findings;
  mechanism::Vector4 noise = mechanism::Vector4::Zero();  ///< of single pictures, from second differences; m and rad
  std::vector<PoseRecording> train, validate;
  std::vector<std::string> rejected, absorbed, notes;
  double condition_max = 0.0;
};

/// How carefully to trace a residual of the pose.
struct PoseTraceOptions {
  double condition_max = 60.0;
  int draws = 399;  ///< surrogates
  std::uint64_t seed = 1;
  int most = 6;  ///< explanations
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// Compares measured pose and forward kinematics. One fixed camera transform is fitted on training recordings; then
/// explanations with one unknown each are added while they pass every test, on training recordings only: more explained
/// than any explanation does on any clean surrogate (fixed transform, and blocks of what nothing explains, with random
/// signs), some coordinate's rms lowered by a tenth, gain on held-back pieces beyond one standard error, physical sign,
/// sign stable when any piece is left out. Explained together with the frame by Gauss-Newton on the whole forward
/// kinematics. Validation recordings are judged with training's frame and delay.
PoseTrace tracePose(const mechanism::Robot& robot, const std::vector<recording::Recording>& train,
                    const std::vector<recording::Recording>& validate, const PoseTraceOptions& options);

}  // namespace knee_robot::tracing
