#pragma once

#include "pose_rows.h"

namespace knee_robot::tracing {

/// The state of the search for explanations of the pose.
struct PoseSearch {
  const mechanism::Robot* robot = nullptr;
  const std::vector<PoseView>* views = nullptr;
  const PoseTraceOptions* options = nullptr;
  PoseStack stack;
  std::vector<PoseHypothesis> hypotheses;
  mechanism::Vector4 sigma = mechanism::Vector4::Ones();  ///< of what nothing explains, per coordinate
  Eigen::VectorXd noise;  ///< what nothing explains, in units of sigma: blocks of it make surrogates
  double rate_hz = 0.0;
  PoseModel model;
  std::vector<PoseFinding> findings;
  std::vector<PoseHypothesis> banned;  ///< were superfluous once
  std::vector<std::string> rejected, absorbed;
};

/// Fits the fixed frame, then sets sigma and noise from the fit of everything at once.
void startPoseSearch(PoseSearch& search);
/// Adds explanations one after the other while they pass every test; takes out what a later one makes superfluous.
void searchPose(PoseSearch& search);

}  // namespace knee_robot::tracing
