#pragma once

#include <memory>
#include <vector>

#include "knee_robot/identification/identify.h"
#include "knee_robot/tracing/effect_input.h"
#include "knee_robot/tracing/stack.h"

namespace knee_robot::tracing {

/// What a baseline is fitted beside: effects, along every recording (samples x axes; empty: none).
struct EffectsBeside {
  std::vector<Eigen::MatrixXd> force_N;  ///< taken off the recorded force first
  std::vector<Eigen::MatrixXd> level;    ///< factors of Coulomb friction, which multiply what its law gives
  std::vector<char> without_peak;        ///< actuators whose law near rest gets no peak; empty: none
  /// Per recording and effect: what force_N is the sum of. Their sizes are open while laws are chosen, or a law would be
  /// chosen that keeps what another law made of them. Empty: they are known.
  std::vector<std::vector<Eigen::MatrixXd>> each_N;
};

/// The baseline: rigid body, Coulomb and viscous friction, rotor and offset per actuator, with the law of friction near
/// rest that held-back data chose: what `identify` fits, in coordinates that the search can fit again beside effects.
struct BaseFit {
  std::vector<identification::Column> columns;
  std::vector<dynamics::FrictionLaw> friction_laws;  ///< per actuator, near rest
  Eigen::VectorXd start;    ///< per column: where the prior pulls to (of a given model, when there is one)
  Eigen::MatrixXd basis;    ///< columns x coordinates: parameters = start + basis * coordinates
  int bounded = 0;          ///< the first coordinates (friction, rotor) are never negative
  Eigen::VectorXd pull;     ///< per coordinate, 0 for bounded ones: root of the prior's weight, for rows of unit noise
  Eigen::VectorXd noise_N;  ///< per actuator: rms residual
  Eigen::VectorXd parameters;
  std::vector<dynamics::TrainedForce> trained_force_N;  ///< per actuator; empty: no pose is ever uncertain
  std::vector<identification::FrictionChoice> choices;  ///< per actuator: what the law rests on

  EffectsBeside beside;

  double strength = 0.0;  ///< of the prior, as chosen or at least as asked for

  int decided = 0;  ///< combinations of parameters that the data decide rather than the prior

  int coordinates() const { return static_cast<int>(basis.cols()); }
  Eigen::VectorXd parametersOf(const Eigen::VectorXd& coordinates) const { return start + basis * coordinates; }
};

/// Everything that a baseline may be told.
struct BaseOptions {
  int rank = 0;  ///< 0: all directions, pulled towards the prior as held-back blocks choose
  /// Parameters of a given model, per column, to which is pulled; friction and rotors, which have a sign, are fitted
  /// anew. Empty: to the prior.
  Eigen::VectorXd given;
  EffectsBeside beside;
  double least_strength = 0.0;                                    ///< of the prior
  std::shared_ptr<const identification::Identification> laws_of;  ///< IdentifyOptions::laws_of
};

/// `identify` without standard errors: the same equations, weights, loss, prior, laws. Sets the Coulomb columns of
/// `training`.
BaseFit fitBase(const mechanism::Robot& robot, std::vector<identification::Observation>& training, const Stack& stack,
                const std::vector<identification::Column>& columns, BaseOptions how = {});

/// A fit of other rows of the same robot, to begin with: sets the Coulomb columns of `training`.
BaseFit laidUnder(BaseFit known, std::vector<identification::Observation>& training);
/// With a noise of 1 N, for rows that are not weighted.
BaseFit inNewtons(BaseFit base);

/// Weighted regressor in base coordinates (rows: actuator after actuator, picks within), and weighted force less that
/// of `start`.
Eigen::MatrixXd baseRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                         const Stack& stack);
Eigen::VectorXd forceRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                          const Stack& stack);

/// Root mean square per actuator, in N, of weighted rows.
Eigen::VectorXd rmsRows(const BaseFit& base, const Stack& stack, const Eigen::VectorXd& rows);

}  // namespace knee_robot::tracing
