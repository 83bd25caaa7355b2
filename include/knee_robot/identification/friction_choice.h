#pragma once

#include <string>
#include <vector>

#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {

/// Where an actuator's laws are looked for: displacements over which friction builds up, speeds at which it is full.
struct FrictionRange {
  double narrowest_m = 2e-5;  ///< no stop is narrower: an encoder's steps
  double widest_m = 2e-3, bristles_most_m = 1e-3;
  double slowest_m_per_s = 1e-4, fastest_m_per_s = 5e-3;
  /// Up to this speed a part of it may go on growing, ever less: viscous friction that a straight line does not
  /// describe.
  double growing_m_per_s = 0.0;
  bool peak = true;  ///< friction may be larger near rest than beyond
};

/// One family of laws that was tried for an actuator.
struct TriedLaw {
  dynamics::FrictionLaw law;  ///< the best of its family on all training data
  int numbers = 1;            ///< shape parameters
  double held_back = 0.0;  ///< mean square over left-out blocks, in units of the noise; its shape chosen without each
  /// held_back minus that of the best family; below 0 where a family with a rare element is better, but not surely.
  double beyond_best = 0.0;
  double standard_error = 0.0;  ///< of beyond_best, over the blocks
  int family = 0;               ///< simplest first (docs/identification.md)
};

/// How one actuator's friction acts near rest, and what that rests on.
struct FrictionChoice {
  dynamics::FrictionLaw law;
  std::vector<TriedLaw> tried;  ///< simplest first
  int family = 0;               ///< of the law, where no other actuator's law was taken for it
};

/// Chooses every actuator's law among one stop, tanh of velocity, bristles (Dahl's, creeping, damped), a spectrum of
/// stops, sums of two, and sums of up to six elements with non-negative shares. Blocks of the training data are left
/// out in turn; within each turn shape and shares are chosen without the block, the other parameters follow by least
/// squares with the prior of `strength`. Chosen is the simplest family within a quarter of a standard error of the
/// best (a whole one where that is the spectrum); one with a clearance or relaxation only where it is surely better
/// than all without. `equations`: weighted, their Coulomb columns set with `present` laws; other actuators keep theirs.
/// Effects beside the model (Observation::beside_N) are open in their sizes. `ranges`, one per actuator. `around`: an
/// earlier choice, between whose shapes and their neighbours finer steps are tried too.
std::vector<FrictionChoice> chooseFriction(const std::vector<Observation>& training, const ObservationOptions& options,
                                           const std::vector<Column>& columns, const Equations& equations,
                                           const Eigen::VectorXd& noise_N, const Reduction& reduction, double strength,
                                           const std::vector<FrictionRange>& ranges,
                                           const std::vector<FrictionChoice>& around = {});

}  // namespace knee_robot::identification
