#pragma once

#include <vector>

#include "knee_robot/identification/columns.h"
#include "knee_robot/tracing/effect_input.h"
#include "knee_robot/tracing/stack.h"

namespace knee_robot::tracing {

/// The baseline: rigid body, Coulomb and viscous friction, rotor and offset per actuator, in the directions that the training
/// data support. Coulomb friction keeps its direction at rest, but builds up within a few encoder counts: what builds up over a
/// longer distance is an effect (presliding), not baseline.
struct BaseFit {
  std::vector<identification::Column> columns;
  std::vector<FrictionMemory> memory;  ///< per actuator
  Eigen::VectorXd start;               ///< per column: from a given model, zero for parameters with a sign; else zero
  Eigen::MatrixXd basis;               ///< columns x rank: parameters = start + basis * coordinates
  int bounded = 0;                     ///< the first coordinates (friction, rotor) are never negative
  Eigen::VectorXd noise_N;             ///< per actuator: rms residual that rows are weighted with
  Eigen::VectorXd parameters;

  int rank() const { return static_cast<int>(basis.cols()); }
  Eigen::VectorXd parametersOf(const Eigen::VectorXd& coordinates) const { return start + basis * coordinates; }
};

/// Fits the baseline to training recordings, choosing widths and rank on them; sets their Coulomb columns. `rank` 0: chosen. With
/// `given` (parameters of a given model, per column) the data correct those in as many directions as that helps held-back blocks;
/// friction and rotors, which have a sign, are fitted anew, and friction's memory is chosen anew: a given one that does not
/// fit that day's stops was taken for presliding. `effects_N` (rows, N, low-passed; may be empty) is taken off the force first:
/// directions that are chosen while an effect is still in the residual stand in for it, and fail on another path.
BaseFit fitBase(const mechanism::Robot& robot, std::vector<identification::Observation>& training, const Stack& stack,
                const std::vector<identification::Column>& columns, int rank, const Eigen::VectorXd* given = nullptr,
                const Eigen::VectorXd& effects_N = {});

/// Memory of each actuator's friction that leaves least, its own friction refitted to `residual_N` (rows); sets the Coulomb columns.
void chooseMemory(const mechanism::Robot& robot, std::vector<identification::Observation>& recordings,
                  const Stack& stack, const Eigen::VectorXd& residual_N, BaseFit& base);

/// Weighted regressor in base coordinates (rows: actuator after actuator, picks within), and weighted force less that of `start`.
Eigen::MatrixXd baseRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                         const Stack& stack);
Eigen::VectorXd forceRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                          const Stack& stack);

/// Root mean square per actuator, in N, of weighted rows.
Eigen::VectorXd rmsRows(const BaseFit& base, const Stack& stack, const Eigen::VectorXd& rows);

}  // namespace knee_robot::tracing
