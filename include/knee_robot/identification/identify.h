#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/identification/accuracy.h"
#include "knee_robot/identification/friction_choice.h"
#include "knee_robot/identification/prior_strength.h"
#include "knee_robot/identification/robust_fit.h"

namespace knee_robot::identification {

struct Identification;

/// Everything that identification may be told.
struct IdentifyOptions {
  ObservationOptions observation;
  bool friction = true;         ///< false: a model without any friction, to show what friction explains
  bool joint_friction = false;  ///< friction of the legs' passive joints too; `training` must be observed with it
  int rank = 0;                 ///< fit only this many directions, without the prior; 0: all, pulled towards it
  /// Narrowest width over which Coulomb friction may build up, in encoder counts. Smaller ones follow the encoder's
  /// flicker at rest; where nothing flickers they meet reversals more exactly.
  double narrowest_counts = 2.0;
  OutlierRule outliers = OutlierRule::Huber;
  bool uncertainty = true;  ///< false: no bootstrap, no standard errors
  /// Parameters, per column, that the fit is pulled towards instead of the robot's own prior; those with a sign do not
  /// count. Empty: the prior's.
  Eigen::VectorXd towards;
  /// The prior's strength is never weaker. Beside an effect a weaker one may seem as good, and the links bend, which
  /// shows at other poses.
  double least_strength = 0.0;
  /// Actuators whose law near rest has no peak, because something else is known to make friction larger there. Empty:
  /// none.
  std::vector<char> without_peak;
  /// A fit of the same observations with the same options: its laws near rest are taken, whose choice is most of the
  /// work, and the result is the same. Null: they are chosen.
  std::shared_ptr<const Identification> laws_of;
};

/// A fitted model, and what its choices rest on. Nothing in here depends on validation data.
struct Identification {
  dynamics::Model model;
  PriorChoice prior;                     ///< strength of the prior, by held-back blocks
  std::vector<FrictionChoice> friction;  ///< per actuator; empty without friction
  Reduction reduction;                   ///< the coordinates that were fitted, and
  Eigen::VectorXd coordinates;           ///< their values
  Eigen::VectorXd parameters;            ///< per column
  Eigen::VectorXd beside_laws;           ///< the same, as they were when the laws near rest were chosen
  std::vector<Eigen::VectorXd>
      parameters_by_strength;  ///< least-squares parameters (all columns) for every point of prior.curve
  std::vector<Column> columns;
  Eigen::VectorXd
      noise_N;  ///< per actuator: rms residual that the equations were weighted with, moving ones, then those near rest
  int equations = 0;
  int blocks = 0;
  double duration_s = 0.0;  ///< of the motion that was fitted
  double outlier_share = 0.0;
  double bootstrap_block_s = 0.0;           ///< standard errors come from a bootstrap of blocks of this length
  Eigen::VectorXd force_rms_N;              ///< per actuator, of the equations
  std::vector<Eigen::MatrixXd> compressed;  ///< per block of cross-validation: compress() of its weighted equations
  std::vector<int> block_rows;              ///< per block: equations
};

/// Identifies the force model of a robot: law of each actuator's friction near rest, noise of each actuator in motion
/// and near rest, strength of the prior by cross-validation, robust bounded fit to all usable samples. Sets the Coulomb
/// columns of `training` to the laws that were chosen. Refusal when the data cannot support it: an axis hardly moves,
/// too little motion, too many saturated samples.
Identification identify(const mechanism::Robot& robot, std::vector<Observation>& training,
                        const IdentifyOptions& options);

/// Width (m) of the narrowest stop that is tried, per actuator: so many encoder counts.
std::vector<double> narrowestWidths(const mechanism::Robot& robot, double counts);

}  // namespace knee_robot::identification
