#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/identification/accuracy.h"
#include "knee_robot/identification/rank.h"
#include "knee_robot/identification/robust_fit.h"

namespace knee_robot::identification {

/// Everything that identification may be told.
struct IdentifyOptions {
  ObservationOptions observation;
  bool friction = true;         ///< false: a model without any friction, to show what friction explains
  bool joint_friction = false;  ///< friction of the legs' passive joints too; `training` must be observed with it
  int rank = 0;                 ///< 0: chosen on the training data
  /// Narrowest width over which Coulomb friction may build up, in encoder counts. Smaller ones follow the encoder's flicker at rest;
  /// where nothing flickers they meet reversals more exactly.
  double narrowest_counts = 2.0;
  OutlierRule outliers = OutlierRule::Huber;
};

/// A fitted model, and what its choices rest on. Nothing in here depends on validation data.
struct Identification {
  dynamics::Model model;
  RankChoice rank;
  std::vector<Eigen::VectorXd>
      parameters_by_rank;  ///< least-squares parameters (all columns) for every point of rank.curve
  std::vector<Column> columns;
  Eigen::VectorXd noise_N;  ///< per actuator: rms residual that the equations were weighted with
  int equations = 0;
  int blocks = 0;
  double duration_s = 0.0;  ///< of the motion that was fitted
  double outlier_share = 0.0;
  double bootstrap_block_s = 0.0;           ///< standard errors come from a bootstrap of blocks of this length
  Eigen::VectorXd force_rms_N;              ///< per actuator, of the equations
  std::vector<Eigen::MatrixXd> compressed;  ///< per block of cross-validation: compress() of its weighted equations
  std::vector<int> block_rows;              ///< per block: equations
};

/// Identifies the force model of a robot: widths of the Coulomb step, noise of each actuator, rank by cross-validation, robust
/// bounded fit. Sets the Coulomb columns of `training` to the widths that were chosen. Refusal when the data cannot support it:
/// an axis hardly moves, too little motion, too many saturated samples.
Identification identify(const mechanism::Robot& robot, std::vector<Observation>& training,
                        const IdentifyOptions& options);

/// Widths (m, per actuator) over which Coulomb friction builds up: for each actuator the one that leaves the smallest residual
/// over all usable training samples, at rest too, when its own friction and offset are refitted to the residual of
/// `parameters`. At least options.narrowest_counts encoder counts.
std::vector<double> chooseCoulombWidths(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                        const std::vector<Observation>& training, const Eigen::VectorXd& parameters,
                                        const IdentifyOptions& options);

/// The narrowest of those widths for every actuator.
std::vector<double> narrowestCoulombWidths(const mechanism::Robot& robot, double counts);

}  // namespace knee_robot::identification
