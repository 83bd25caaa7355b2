#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::tracing {

/// One sample that is fitted: of which recording, in which block of cross-validation.
struct Pick {
  std::size_t recording = 0;
  int sample = 0;
  int block = 0;
};

/// The samples that tracing works with: all usable ones, at rest too, thinned to what the cut-off leaves. The same for
/// every actuator. Blocks are contiguous pieces of about equal length, cut where the robot is slowest.
struct Stack {
  std::vector<Pick> picks;
  int blocks = 0;
  int axes = 0;
  double cutoff_hz = 0.0;
  double rate_hz = 0.0;  ///< of the picks
  int most_rows = 0;     ///< of the baseline's equations: ObservationOptions::most_rows

  Eigen::Index size() const { return static_cast<Eigen::Index>(picks.size()); }
};

Stack makeStack(const std::vector<identification::Observation>& recordings,
                const identification::ObservationOptions& options);

/// Which samples count. At rest friction may take any value, so that stops and reversals leave much that is no effect;
/// but presliding lives there.
enum class Attention {
  Moving,  ///< samples at which the actuator is at rest or near it count little
  All,     ///< all alike
};

/// Factor of every row (actuator after actuator); mean square 1 for each actuator.
Eigen::VectorXd rowScale(const Stack& stack, const std::vector<identification::Observation>& recordings,
                         Attention attention);

/// Columns along the recordings (one matrix per recording: samples x columns), low-passed as the force is, at the
/// picks.
Eigen::MatrixXd gather(const Stack& stack, const std::vector<identification::Observation>& recordings,
                       std::vector<Eigen::MatrixXd> columns);

/// What is already low-passed, at the picks: recorded force minus nothing.
Eigen::VectorXd gatherForce(const Stack& stack, const std::vector<identification::Observation>& recordings,
                            int actuator);

}  // namespace knee_robot::tracing
