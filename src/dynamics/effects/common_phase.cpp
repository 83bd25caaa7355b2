#include "common_phase.h"

#include <Eigen/Core>
#include <algorithm>

namespace knee_robot::dynamics {

std::vector<double> commonPhase(const std::vector<double>& each) {
  if (each.size() <= 2) return each;
  const Eigen::Index recordings = static_cast<Eigen::Index>(each.size() / 2);
  const Eigen::Map<const Eigen::Matrix2Xd> pairs(each.data(), 2, recordings);
  const Eigen::Vector2d mean = pairs.rowwise().mean();
  const double spread = (pairs.colwise() - mean).squaredNorm() / static_cast<double>(recordings - 1);
  const double support = 1.0 - spread / std::max(1e-300, static_cast<double>(recordings) * mean.squaredNorm());
  return {support * mean[0], support * mean[1]};
}

}  // namespace knee_robot::dynamics
