#include "knee_robot/identification/trained_range.h"

#include <algorithm>
#include <limits>

namespace knee_robot::identification {

std::vector<dynamics::TrainedForce> trainedRange(const std::vector<Observation>& training) {
  std::vector<dynamics::TrainedForce> trained;
  if (training.front().motion.uncertain.empty()) return trained;
  const double infinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < training.front().axes(); ++i) {
    dynamics::TrainedForce range = {infinity, -infinity};
    for (const Observation& o : training) {
      for (int n = 0; n < o.samples(); ++n) {
        if (!o.usable[static_cast<std::size_t>(n)]) continue;
        range.low_N = std::min(range.low_N, o.force_filtered_N(n, i));
        range.high_N = std::max(range.high_N, o.force_filtered_N(n, i));
      }
    }
    trained.push_back(range);
  }
  return trained;
}

void keepWithinTrainedRange(const std::vector<dynamics::TrainedForce>& trained, const MotionPath& motion,
                            Eigen::MatrixXd& force_N) {
  if (trained.empty() || motion.uncertain.empty()) return;
  for (Eigen::Index i = 0; i < force_N.cols(); ++i) {
    const dynamics::TrainedForce& range = trained[static_cast<std::size_t>(i)];
    const double margin_N = kBeyondTrained * (range.high_N - range.low_N);
    for (Eigen::Index n = 0; n < force_N.rows(); ++n) {
      if (motion.uncertain[static_cast<std::size_t>(n)])
        force_N(n, i) = std::clamp(force_N(n, i), range.low_N - margin_N, range.high_N + margin_N);
    }
  }
}

}  // namespace knee_robot::identification
