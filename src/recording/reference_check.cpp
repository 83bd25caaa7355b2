#include "reference_check.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"

namespace knee_robot::recording {
namespace {

// Followed references of real robots stay far from all of these: they are within a few per cent of the travel.
constexpr double kMoves_m = 5e-3;  ///< travel (joints: at a radius of kJointRadius_m) below which nothing can be told
constexpr double kShareOfMost = 0.1;  ///< of the axis that moves most: others may only yield
constexpr double kStands = 0.01;      ///< of the motion's standard deviation
constexpr double kOtherScale = 5.0;   ///< times it
constexpr double kCorrelates = 0.5;   ///< a reference with less is followed by a quarter of the motion
constexpr double kFarError = 0.25;    ///< of the axis' travel: rms error of a reference that may be another axis'
constexpr double kNearer = 5.0;       ///< times nearer to the other axis
constexpr double kFarTravels = 2.0;   ///< travels between reference and axis, and
constexpr double kFar_m = 0.1;        ///< so far at least

double deviation(const Eigen::VectorXd& x) {
  return std::sqrt((x.array() - x.mean()).square().mean());
}

double correlation(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  return ((x.array() - x.mean()) * (y.array() - y.mean())).mean() / (deviation(x) * deviation(y));
}

double rmsDistance(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  return std::sqrt((x - y).squaredNorm() / static_cast<double>(x.size()));
}

/// Axis that this reference fits far better than its own; -1: none.
int otherAxis(const Recording& r, int axis, double travel) {
  const double own = rmsDistance(r.reference_m.col(axis), r.position_m.col(axis));
  for (int j = 0; j < r.axes; ++j) {
    if (j != axis && own > kFarError * travel &&
        kNearer * rmsDistance(r.reference_m.col(axis), r.position_m.col(j)) < own)
      return j;
  }
  return -1;
}

std::string whyNot(const Recording& r, int axis, double travel) {
  const Eigen::VectorXd wanted = r.reference_m.col(axis), done = r.position_m.col(axis);
  const double ratio = deviation(wanted) / deviation(done);
  if (ratio < kStands) return "stands while the axis moves";
  if (const int other = otherAxis(r, axis, travel); other >= 0)
    return "is what axis " + std::to_string(other + 1) + " does";
  if (ratio > kOtherScale || ratio < 1.0 / kOtherScale)
    return "moves " + shortNumber(ratio, 3) + " times as far as the axis (is it in another unit?)";
  const double together = correlation(wanted, done);
  if (together < kCorrelates) return "moves otherwise than the axis (correlation " + shortNumber(together, 2) + ")";
  const double away = std::abs((wanted - done).mean());
  if (away > kFarTravels * travel && away > kFar_m)
    return "lies " + shortNumber(away / travel, 2) + " times the axis' travel away from it";
  return {};
}

}  // namespace

std::string whyNotFollowed(const Recording& r) {
  if (r.reference_m.cols() != r.position_m.cols() || r.rows() == 0) return {};
  const Eigen::RowVectorXd travel = r.position_m.colwise().maxCoeff() - r.position_m.colwise().minCoeff();
  for (int i = 0; i < static_cast<int>(travel.size()); ++i) {
    if (travel[i] < kMoves_m || travel[i] < kShareOfMost * travel.maxCoeff()) continue;
    const std::string why = whyNot(r, i, travel[i]);
    if (!why.empty()) return "reference " + std::to_string(i + 1) + " " + why;
  }
  return {};
}

}  // namespace knee_robot::recording
