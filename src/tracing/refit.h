#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Root mean square per actuator of rows in N.
Eigen::VectorXd rmsOf(const Stack& stack, const Eigen::VectorXd& residual_N);

/// Hypotheses of the effects found so far.
std::vector<Hypothesis> hypothesesOf(const std::vector<FoundEffect>& effects);

/// Base and these effects along the recordings, weighted with the search's rms.
JointProblem problemOf(const Search& search, const std::vector<Hypothesis>& effects);

/// Those fitted together, with every block left out in turn.
JointFit fitOf(const Search& search, const std::vector<Hypothesis>& effects, LeftOut left_out = LeftOut::EveryBlock);

/// Squares left on held-back blocks by base and effects as they stand, over all samples alike, weighted with `noise_N`.
Eigen::VectorXd heldBackInAll(const Search& search, const Eigen::VectorXd& noise_N);

/// By how much the residual's rms (per actuator, N) falls with effect `k` of the model as it stands: the root of the
/// squares' difference.
Eigen::VectorXd explainedBy(const Search& search, std::size_t k);

/// What every effect explains of the model as it stands, where that is more than when it was found: its shape and the
/// laws beside it were not settled then.
void explainAnew(Search& search);

/// The model as it stands.
SurrogateModel modelOf(const Search& search);

/// Fits base and effects together and rebuilds what depends on the fit (loads, forces), twice.
void refit(Search& search);

/// Fits the baseline and chooses its laws of friction near rest anew, with the effects' forces taken off, and fits
/// again. The prior is as strong as held-back blocks choose, and at least this.
/// True when the law of friction has changed.
bool rebase(Search& search, double least_strength = 0.0);

/// Puts another baseline under the effects, with its laws near rest, and fits again. True when those laws are others.
bool adoptBase(Search& search, BaseFit base);

}  // namespace knee_robot::tracing
