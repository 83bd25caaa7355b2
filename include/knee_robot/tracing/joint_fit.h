#pragma once

#include <vector>

#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// Baseline and effects fitted together.
struct JointFit {
  Eigen::VectorXd base, base_std;             ///< base coordinates; std by leaving blocks out in turn
  std::vector<Eigen::VectorXd> coefficients;  ///< per effect
  /// Of those, by leaving blocks out in turn (jackknife); nan of an effect that acts in fewer than three blocks, as a
  /// short push does.
  std::vector<Eigen::VectorXd> std;
  std::vector<char> stable;    ///< per effect: no left-out block changes the sign of its leading coefficient
  Eigen::VectorXd residual_N;  ///< rows
  Eigen::VectorXd held_back;   ///< per block: sum of weighted squares when it was left out
};

enum class LeftOut { EveryBlock, None };

/// Bounded weighted least squares of the force on base and effect columns; with every block left out in turn, or
/// without that: held_back is empty then, and what is told by it nan. `effect_rows[k]` belongs to `effects[k]` and is in
/// N.
JointFit fitJointly(const TraceData& data, const BaseFit& base, const Eigen::VectorXd& noise_N,
                    const std::vector<Hypothesis>& effects, const std::vector<Eigen::MatrixXd>& effect_rows,
                    LeftOut left_out = LeftOut::EveryBlock);

}  // namespace knee_robot::tracing
