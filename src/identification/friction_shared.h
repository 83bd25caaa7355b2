#pragma once

#include <limits>
#include <vector>

#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::identification {

/// The best sum of one or more elements for some sums of squares.
struct Sum {
  std::vector<int> which;
  Eigen::VectorXd weights;
  double left = std::numeric_limits<double>::infinity();
};

/// How other actuators' laws did on one actuator: mean square of every block, and that of its own best family.
struct OthersLaws {
  Eigen::MatrixXd error;  ///< blocks x laws
  Eigen::VectorXd best, share;
};

/// Laws that several actuators may share: what was chosen for each of them, and the single elements that were tried.
std::vector<dynamics::FrictionLaw> sharedLaws(const std::vector<FrictionChoice>& around);

/// Puts the elements of laws among those that are tried.
std::vector<Sum> inElements(const std::vector<dynamics::FrictionLaw>& laws,
                            std::vector<dynamics::FrictionElement>& elements);

/// Gives actuators the law of the velocity that half of them or more have, each with its own speed, where theirs is not
/// surely better: actuators of one machine are alike, and a sum of laws fits what training does not tell.
void shareFamily(std::vector<FrictionChoice>& choices);

/// Actuators of one machine are alike: a law that is within half a standard error of the best on most of them is taken
/// by all of those. What one actuator's data do not show (how friction lets go at rest) the others' may. A rare law
/// is taken only where the actuator has chosen such a one itself. No stop becomes narrower than `narrowest_m` of its
/// actuator.
void shareLaw(const std::vector<dynamics::FrictionLaw>& laws, const std::vector<OthersLaws>& others,
              const std::vector<double>& narrowest_m, std::vector<FrictionChoice>& choices);

}  // namespace knee_robot::identification
