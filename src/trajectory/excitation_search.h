#pragma once

#include "excitation_problem.h"

namespace knee_robot {

/// A feasible series and its k.
struct Candidate {
  Eigen::VectorXd variables;
  double k = 0.0;
};

struct SearchResult {
  std::vector<Candidate> found;  ///< feasible ones, best first
  double random_k = 0.0;         ///< of the best random one
  int feasible = 0;              ///< random candidates
  int evaluations = 0;
  bool cut_short = false;
};

/// Random feasible candidates, then L-BFGS from the best of them, on all cores. What each candidate and each start yields
/// depends on the seed and its number alone, so the result does not depend on the number of threads.
SearchResult searchExcitation(const ExcitationProblem& problem, const ExcitationOptions& options);

}  // namespace knee_robot
