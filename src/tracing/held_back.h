#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Squares (weighted) that a model with these effects leaves in each part of the training recordings, everything but
/// shapes and laws fitted without it.
using HeldBack = Eigen::VectorXd (*)(Search& search, const std::vector<Hypothesis>& effects,
                                     const Eigen::VectorXd& noise_N);

/// Parts: stretches of positions in two directions.
Eigen::VectorXd heldBackPositions(Search& search, const std::vector<Hypothesis>& effects,
                                  const Eigen::VectorXd& noise_N);
/// Parts: the paths that recordings follow. Of one path nothing is left to fit to.
Eigen::VectorXd heldBackPaths(Search& search, const std::vector<Hypothesis>& effects, const Eigen::VectorXd& noise_N);

/// The same of the baseline with its own laws near rest, and with what is local.
Eigen::VectorXd baselineLeaves(Search& search, const BaseFit& baseline, const std::vector<Hypothesis>& local,
                               const Eigen::VectorXd& noise_N, HeldBack held_back);

/// Whether an effect that saves these squares on what was held back, while axes move and in all samples, speaks against
/// itself: in both, because near rest friction may take any value. A force that depends on the pose acts in motion as at
/// rest: in one of them.
bool harmsElsewhere(double moving, double all, bool force_field);

/// Has a force in other recordings.
bool isPredicted(const FoundEffect& effect);

/// Of recordings along two paths or more each is left out in turn. An effect that makes the error there larger is not
/// predicted elsewhere, the worst first; where all that is left is worse than the baseline, nothing is. Parts of paths
/// that are known otherwise do not show this.
void holdBackOfPaths(Search& search, const BaseFit& baseline, std::vector<std::string>& notes);

}  // namespace knee_robot::tracing
