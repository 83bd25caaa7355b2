#pragma once

#include <string>
#include <vector>

#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// Rms per actuator (N) below which nothing can be explained.
struct NoiseFloor {
  Eigen::VectorXd rms_N;
  Eigen::VectorXd
      of_names_N;  ///< what is left beside right names: the noise, or 0.003 of the force, whichever is larger
  std::string source;
  bool measured = false;  ///< by repeats; otherwise estimated
};

/// From recordings that repeat each other's reference (in time: rows may be missing, or one waited longer), and from
/// cycles that a recording repeats within itself, when there are any (found by themselves): rms of the difference of
/// their residuals over sqrt 2, without events: blocks of a second in which it is more than three times as large as in
/// the middle one happened in one run only, and are no noise; neither is friction that differs smoothly between
/// recordings (one of them was warm). `source` says which. Otherwise an estimate: what surrogates leave
/// (`surrogate_residual_N`), together with the noise density of the unfiltered force residual just above the cut-off,
/// carried down to it. Never below three thousandths of the rms force, with repeats one: what is smaller is not looked
/// for.
NoiseFloor noiseFloor(const std::vector<recording::Recording>& recordings, const TraceData& data,
                      const std::vector<Eigen::MatrixXd>& model_force_N, const Eigen::VectorXd& surrogate_residual_N);

}  // namespace knee_robot::tracing
