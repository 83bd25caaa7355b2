#pragma once

#include "excitation_problem.h"

namespace knee_robot::excitation {

/// A feasible series and its cost (SpectralCost, not smoothed).
struct Candidate {
  Eigen::VectorXd variables;
  double cost = 0.0;
};

struct SearchResult {
  std::vector<Candidate> found;  ///< feasible ones, best first
  Candidate random;              ///< the best random one
  int feasible = 0;              ///< random candidates
  int evaluations = 0;
  bool cut_short = false;
};

/// Random feasible candidates, then NLopt's SLSQP from the best of them, on all cores. What each candidate and each
/// start yields depends on the seed and its number alone, so the result does not depend on the number of threads.
SearchResult searchExcitation(ExcitationProblem& problem, const ExcitationOptions& options);

/// The best `options.starts` of the random candidates, not improved.
std::vector<Candidate> randomStarts(ExcitationProblem& problem, const ExcitationOptions& options);

/// One of these starts alone, on this thread.
Candidate improveOne(const ExcitationProblem& problem, const ExcitationOptions& options, const Candidate& from);

}  // namespace knee_robot::excitation
