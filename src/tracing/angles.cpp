#include "knee_robot/tracing/angles.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/parallel.h"

namespace knee_robot::tracing {
namespace {

constexpr double kAbsorbedNorm = 1e-3;  ///< share of a column's norm that must be left beside the base
constexpr std::size_t kNearest = 3;

/// Columns of one place, in unit length, and what is left of them beside the base.
struct Group {
  Place place;
  Eigen::MatrixXd q;     ///< orthonormal, of the columns
  Eigen::MatrixXd left;  ///< orthonormal, of what is left; empty: absorbed
};

Eigen::MatrixXd spanOf(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return columns;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(kAbsorbedNorm);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

Group groupOf(const TraceData& data, const Hypothesis& h, const Projection& base, const Eigen::VectorXd& noise_N) {
  Group g;
  g.place = h.place;
  Eigen::MatrixXd columns = weighted(data.stack, effectRows(data, h), noise_N);
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    columns.col(c) /= std::max(1e-300, columns.col(c).norm());
  g.q = spanOf(columns);
  const Eigen::MatrixXd rest = columns - base.q * (base.q.transpose() * columns);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index c = 0; c < rest.cols(); ++c) {
    if (rest.col(c).norm() > kAbsorbedNorm) kept.push_back(c);
  }
  Eigen::MatrixXd seen(rest.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    seen.col(static_cast<Eigen::Index>(k)) = rest.col(kept[k]);
  g.left = spanOf(seen);
  return g;
}

Eigen::VectorXd cosines(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a.transpose() * b).singularValues().cwiseMin(1.0);
}

}  // namespace

std::vector<PlaceAngles> principalAngles(const TraceData& data, const std::vector<PlaceColumns>& places,
                                         const Projection& base, const Eigen::VectorXd& noise_N) {
  std::vector<const PlaceColumns*> named;
  for (const PlaceColumns& p : places) {
    if (!p.place().candidate->isMap()) named.push_back(&p);
  }
  std::vector<Group> groups(named.size());
  inParallel(named.size(), [&](std::size_t k) {
    const PlaceColumns& p = *named[k];
    Eigen::Index best = 0;
    explained(makeProbes(data, p.tried, p.rows, p.first_row, base, noise_N), base.residual).col(0).maxCoeff(&best);
    groups[k] = groupOf(data, p.tried[static_cast<std::size_t>(best)], base, noise_N);
  });
  std::vector<PlaceAngles> out(groups.size());
  inParallel(groups.size(), [&](std::size_t k) {
    const Group& g = groups[k];
    PlaceAngles& a = out[k];
    a.place = g.place;
    if (g.q.cols() > 0) {
      const Eigen::VectorXd to_base = cosines(base.q, g.q);
      a.base_smallest = std::acos(to_base.maxCoeff());
      a.base_largest = std::acos(to_base.minCoeff());
    }
    for (const Group& other : groups) {
      const bool together =
          g.place.actuator < 0 || other.place.actuator < 0 || other.place.actuator == g.place.actuator;
      if (!together || other.place == g.place || g.left.cols() == 0 || other.left.cols() == 0) continue;
      a.nearest.push_back({other.place, std::acos(cosines(g.left, other.left).maxCoeff())});
    }
    std::sort(a.nearest.begin(), a.nearest.end(), [](const auto& x, const auto& y) { return x.angle < y.angle; });
    a.nearest.resize(std::min(a.nearest.size(), kNearest));
  });
  return out;
}

}  // namespace knee_robot::tracing
