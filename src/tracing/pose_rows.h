#pragma once

#include <vector>

#include "knee_robot/tracing/pose_trace.h"

namespace knee_robot::tracing {

/// One recording with a camera, prepared: what does not depend on the fit.
struct PoseView {
  const recording::Recording* recording = nullptr;
  PosePath measured;
  CameraAlignment own;
  Eigen::MatrixXd camera;          ///< rows x 4, camera's frame, at the encoders' times
  Eigen::MatrixXd travel;          ///< rows x 4: direction of travel of each leg, remembered at rest, in [-1, 1]
  Eigen::MatrixXd load;            ///< rows x 4: sign of each leg's low-passed force, smooth through zero
  std::vector<Eigen::Index> rows;  ///< that are compared
  int other_solution = 0, near_singular = 0, distrusted = 0;
};

/// Without rows and camera when the recording has too few pictures. `delay_s`: nan: its own.
PoseView viewPose(const mechanism::Robot& robot, const recording::Recording& recording, double condition_max,
                  double delay_s);

/// Reads the camera with another delay; drops rows that then have no picture.
void setDelay(PoseView& view, double delay_s);

/// All explanations that a robot allows, each with one unknown.
std::vector<PoseHypothesis> poseHypotheses(const std::vector<PoseView>& views);

/// The mechanism with the model's dimensions, and the lengths (rows x 4) with its offsets and clearances.
mechanism::Mechanism changedMechanism(const mechanism::Mechanism& mechanism, const PoseModel& model);
Eigen::MatrixXd changedLengths(const PoseView& view, const PoseModel& model);

/// Rows that a fit sees: views one after the other, four coordinates a row, thinned.
struct PoseStack {
  struct Pick {
    std::size_t view;
    Eigen::Index row;
    int piece;  ///< of cross-validation
  };
  std::vector<Pick> picks;
  int pieces = 0;
};
/// At most `rate_hz` rows a second, one a second at rest. Pieces: recordings when there are several, else eight
/// contiguous parts.
PoseStack stackPose(const std::vector<PoseView>& views, double rate_hz);

/// Camera minus model at the picks (4 a pick), and its derivative by turn, shift X, shift Z, plate, and by the
/// hypotheses.
struct PoseEquations {
  Eigen::VectorXd residual;
  Eigen::MatrixXd frame;       ///< 4 n x 4
  Eigen::MatrixXd hypotheses;  ///< 4 n x count
};
PoseEquations poseEquations(const mechanism::Robot& robot, const std::vector<PoseView>& views, const PoseStack& stack,
                            const PoseModel& model, const std::vector<PoseHypothesis>& hypotheses);

/// Gauss-Newton on frame and causes from the model's present values, with rows weighed by 1 / sigma of their coordinate
/// and only those of `use` (all when empty). Half plays stay at zero or above.
void fitPose(const mechanism::Robot& robot, const std::vector<PoseView>& views, const PoseStack& stack,
             const mechanism::Vector4& sigma, const std::vector<char>& use, PoseModel& model);

}  // namespace knee_robot::tracing
