#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::identification {

/// One axis as its position loop meets it, from a recording with quick moves: F(t - delay) = sum_j M_j a_j + b v + c
/// sign(v) + g.
/// The sum is over the axes that are commanded to move meanwhile; what the others do while their loops hold them
/// belongs to the axis.
/// Standard errors by leaving eighths of the recording out in turn.
struct AxisResponse {
  double mass_kg = 0.0, mass_std = 0.0;  ///< own inertia, rotor included, at the recorded pose
  double viscous_N_s_per_m = 0.0, viscous_std = 0.0;
  double coulomb_N = 0.0, coulomb_std = 0.0;
  double delay_s = 0.0, delay_std = 0.0;  ///< from the command to its force, beyond the hold of one row
  double explained = 0.0;                 ///< share of the force's variance
  double cutoff_hz = 0.0;                 ///< the motion is known up to here: encoder steps hide what is beyond
  double position_mean_m = 0.0;
};

/// All axes of one recording.
struct AxisResponses {
  double period_s = 0.0;  ///< of the rows
  std::vector<AxisResponse> axes;
  std::vector<std::string> reasons;  ///< why an axis can not be judged, one sentence each; empty where it can
  Eigen::MatrixXd force_N, model_N;  ///< low-passed, per row of the grid: for a plot
  std::vector<double> time_s;
};

/// `response.reasons[i]` says why axis i is not known well enough (it hardly moves, moves with another one, the fit
/// does not explain the force, mass or delay are too uncertain). Refusal when the whole recording is of no use: too
/// short, too slow, no commanded force.
AxisResponses axisResponses(const mechanism::Robot& robot, const recording::Recording& recording);

}  // namespace knee_robot::identification
