#include "repeated_friction.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr Eigen::Index kTimeKnots = 6;  ///< in time
constexpr Eigen::Index kBlocks = 12;    ///< of time, left out in turn
constexpr double kRepeatErrors = 2.0;   ///< standard errors by which held-back blocks must gain

/// Hat functions over the rows, times dry and viscous friction.
Eigen::MatrixXd frictionInTime(const Eigen::VectorXd& share, const Eigen::VectorXd& velocity) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(share.size(), 2 * kTimeKnots);
  for (Eigen::Index n = 0; n < share.size(); ++n) {
    const double at = static_cast<double>(n * (kTimeKnots - 1)) / static_cast<double>(share.size());
    const Eigen::Index k = static_cast<Eigen::Index>(at);
    const double part = at - static_cast<double>(k);
    out(n, k) = (1.0 - part) * share[n];
    out(n, k + 1) = part * share[n];
    out(n, kTimeKnots + k) = (1.0 - part) * velocity[n];
    out(n, kTimeKnots + k + 1) = part * velocity[n];
  }
  return out;
}

}  // namespace

double surenessOf(const Eigen::MatrixXd& columns, const Eigen::VectorXd& difference) {
  const Eigen::Index rows = difference.size();
  Eigen::VectorXd gain(kBlocks);
  for (Eigen::Index b = 0; b < kBlocks; ++b) {
    const Eigen::Index from = b * rows / kBlocks, count = (b + 1) * rows / kBlocks - from;
    Eigen::MatrixXd others = columns;
    others.middleRows(from, count).setZero();
    const Eigen::VectorXd fitted = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(others).solve(difference);
    const Eigen::VectorXd own = difference.segment(from, count);
    gain[b] = own.squaredNorm() - (own - columns.middleRows(from, count) * fitted).squaredNorm();
  }
  const HeldBackGain g = heldBackGain(gain);
  return g.mean / std::max(1e-300, g.error);
}

Eigen::VectorXd takeOutFrictionOfRuns(const Eigen::MatrixXd& share, const Eigen::MatrixXd& velocity,
                                      Eigen::MatrixXd& difference) {
  Eigen::VectorXd taken = Eigen::VectorXd::Zero(difference.cols());
  if (difference.rows() < kBlocks * kTimeKnots) return taken;
  for (Eigen::Index i = 0; i < difference.cols(); ++i) {
    const Eigen::MatrixXd columns = frictionInTime(share.col(i), velocity.col(i));
    if (!(surenessOf(columns, difference.col(i)) > kRepeatErrors)) continue;
    const Eigen::VectorXd friction =
        columns * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(columns).solve(difference.col(i));
    taken[i] = friction.norm() / std::sqrt(static_cast<double>(friction.size()));
    difference.col(i) -= friction;
  }
  return taken;
}

double takeOutPayloadOfRuns(const std::vector<Eigen::MatrixXd>& carried, Eigen::MatrixXd& difference) {
  const Eigen::Index axes = difference.cols(), rows = difference.rows();
  if (rows < kBlocks * kTimeKnots) return 0.0;
  Eigen::MatrixXd columns(rows * axes, carried.front().cols());  // instant by instant, so that blocks are times
  Eigen::VectorXd all(rows * axes);
  for (Eigen::Index n = 0; n < rows; ++n) {
    for (Eigen::Index i = 0; i < axes; ++i) {
      columns.row(n * axes + i) = carried[static_cast<std::size_t>(i)].row(n);
      all[n * axes + i] = difference(n, i);
    }
  }
  if (!(surenessOf(columns, all) > kRepeatErrors)) return 0.0;
  const Eigen::VectorXd mass = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(columns).solve(all);
  double most = 0.0;
  for (Eigen::Index i = 0; i < axes; ++i) {
    const Eigen::VectorXd force = carried[static_cast<std::size_t>(i)] * mass;
    most = std::max(most, force.norm() / std::sqrt(static_cast<double>(rows)));
    difference.col(i) -= force;
  }
  return most;
}

}  // namespace knee_robot::tracing
