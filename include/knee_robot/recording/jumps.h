#pragma once

#include <vector>

#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// A step between two rows of one position that no motion makes: the encoder lost counts, was set anew, or had been
/// frozen until then.
struct Jump {
  int axis = 0;
  int row = 0;            ///< after the step
  double step_m = 0.0;    ///< between the two rows
  double beyond_m = 0.0;  ///< of it, what the motion around it does not explain
  double m_per_s = 0.0;   ///< how fast a motion would have been
  double frozen_s = 0.0;  ///< so long before it the position had been exactly one value, as nowhere else; 0: it had not
  double from_s = 0.0;    ///< nothing is known of the motion between here
  double to_s = 0.0;      ///< and here
};

/// Jumps of all axes from row `first` on. `fastest_m_per_s`: speed that each axis can have; an entry that is not positive
/// and finite: not known, no jump is found there. A jump is three times as fast and stands out of the steps around it, or
/// is faster and stands out by far.
std::vector<Jump> findJumps(const Recording& recording, int first, const std::vector<double>& fastest_m_per_s);

/// What the jumps up to each of these times have added to the positions; one column an axis.
Eigen::MatrixXd jumpsUntil(const std::vector<Jump>& jumps, const std::vector<double>& times_s, Eigen::Index axes);

}  // namespace knee_robot::recording
