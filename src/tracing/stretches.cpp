#include "stretches.h"

#include <Eigen/SVD>
#include <algorithm>
#include <numeric>

namespace knee_robot::tracing {

Eigen::MatrixXd positionsOf(const std::vector<identification::Observation>& recordings, const Stack& stack) {
  Eigen::MatrixXd positions(stack.size(), stack.axes);
  for (Eigen::Index n = 0; n < stack.size(); ++n) {
    const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
    positions.row(n) = recordings[pick.recording].signals.position_m.row(pick.sample);
  }
  return positions;
}

void labelBy(const Eigen::VectorXd& along, Stack& stack) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(stack.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return along[a] < along[b]; });
  for (std::size_t k = 0; k < order.size(); ++k)
    stack.picks[static_cast<std::size_t>(order[k])].block = static_cast<int>(k * kStretches / order.size());
  stack.blocks = kStretches;
}

void labelByPosition(const std::vector<identification::Observation>& recordings, int direction, Stack& stack) {
  Eigen::MatrixXd positions = positionsOf(recordings, stack);
  positions.rowwise() -= positions.colwise().mean().eval();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(positions.transpose() * positions, Eigen::ComputeFullU);
  labelBy(positions * svd.matrixU().col(std::min(direction, stack.axes - 1)), stack);
}

}  // namespace knee_robot::tracing
