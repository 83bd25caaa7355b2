#include "knee_robot/identification/prior_strength.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/parallel.h"

namespace knee_robot::identification {
namespace {

constexpr double kWorst =
    1e6;  ///< an error beyond this counts as this: one block must not decide alone by an absurd figure

const double kPriorStrengths[] = {1e7, 1e6, 1e5, 1e4, 1e3, 3e2, 1e2, 3e1, 1e1, 1.0, 1e-1};

/// Squared norm of triangle's residual, per equation; the triangle holds the same sums as the rows it came from.
double meanSquare(const Eigen::MatrixXd& triangle, const Eigen::VectorXd& parameters, int rows) {
  const Eigen::Index p = triangle.cols() - 1;
  return (triangle.col(p) - triangle.leftCols(p) * parameters).squaredNorm() / rows;
}

/// Held-back error at every strength (columns) for every block (rows), and each block's share of the equations.
struct HeldBack {
  Eigen::MatrixXd error;
  Eigen::VectorXd share;
};

/// The largest unit coordinate of a link that these parameters need.
double largestChange(const Reduction& r, const Eigen::VectorXd& parameters, const Prior& prior) {
  if (prior.links == 0) return 0.0;
  const Eigen::VectorXd change = parameters - prior.mean;
  const Eigen::VectorXd units =
      prior.transform(r.others, Eigen::all).completeOrthogonalDecomposition().solve(change(r.others));
  return units.head(prior.links).cwiseAbs().maxCoeff();
}

/// Standard errors of the points, paired with the best one of those that are believed.
void comparePoints(const HeldBack& held, int blocks, PriorChoice& choice) {
  const Eigen::RowVectorXd mean = held.share.transpose() * held.error;
  Eigen::Index best = 0;
  for (Eigen::Index k = 1; k < mean.size(); ++k) {
    if (choice.curve[static_cast<std::size_t>(k)].believed && mean[k] < mean[best]) best = k;
  }
  for (Eigen::Index k = 0; k < mean.size(); ++k) {
    StrengthPoint& point = choice.curve[static_cast<std::size_t>(k)];
    point.held_back = mean[k];
    const Eigen::VectorXd worse = held.error.col(k) - held.error.col(best);
    point.beyond_best = mean[k] - mean[best];
    const double variance = (held.share.array() * (worse.array() - point.beyond_best).square()).sum();
    point.standard_error = blocks > 1 ? std::sqrt(variance / (blocks - 1)) : 0.0;
  }
}

}  // namespace

int supportedRank(const Reduction& r, double strength) {
  const double supported = (r.information.array() / (r.information.array() + strength)).sum();
  return r.minimalRank() + static_cast<int>(std::lround(supported));
}

double middleStrength(const PriorChoice& choice) {
  double best = choice.strength;
  for (const StrengthPoint& point : choice.curve) {
    if (point.believed && point.beyond_best <= 0.0) best = point.strength;
  }
  return std::sqrt(best * choice.strength);
}

std::vector<Eigen::VectorXd> parametersByStrength(const Reduction& r, const PriorChoice& choice) {
  std::vector<Eigen::VectorXd> all;
  for (const StrengthPoint& point : choice.curve)
    all.push_back(toParameters(r, solveWithPrior(r, r.maximalRank(), point.strength)));
  return all;
}

PriorChoice chooseStrength(const Equations& e, const std::vector<Column>& columns, const std::vector<char>& use,
                           const Prior& prior) {
  const std::vector<Eigen::MatrixXd> blocks = compressBlocks(e);
  HeldBack held;
  held.error.resize(e.blocks, static_cast<Eigen::Index>(std::size(kPriorStrengths)));
  held.share.resize(e.blocks);
  const std::vector<Eigen::MatrixXd> others = joinOthers(blocks);
  inParallel(blocks.size(), [&](std::size_t b) {
    const Eigen::Index block = static_cast<Eigen::Index>(b);
    const int rows = static_cast<int>(std::count(e.block.begin(), e.block.end(), static_cast<int>(b)));
    held.share[block] = static_cast<double>(rows) / e.rows();
    const Reduction r = reduce(others[b], columns, use, prior);
    for (std::size_t k = 0; k < std::size(kPriorStrengths); ++k) {
      const Eigen::VectorXd parameters = toParameters(r, solveWithPrior(r, r.maximalRank(), kPriorStrengths[k]));
      held.error(block, static_cast<Eigen::Index>(k)) = std::min(kWorst, meanSquare(blocks[b], parameters, rows));
    }
  });
  const Eigen::MatrixXd everything = joinBlocks(blocks, -1);
  const Reduction all = reduce(everything, columns, use, prior);
  PriorChoice choice;
  for (const double strength : kPriorStrengths) {
    StrengthPoint point;
    point.strength = strength;
    point.rank = supportedRank(all, strength);
    const Eigen::VectorXd parameters = toParameters(all, solveWithPrior(all, all.maximalRank(), strength));
    point.training = meanSquare(everything, parameters, e.rows());
    point.largest_change = largestChange(all, parameters, prior);
    point.believed = choice.curve.empty() || point.largest_change <= prior.largest_change;
    choice.curve.push_back(point);
  }
  comparePoints(held, e.blocks, choice);
  for (const StrengthPoint& point : choice.curve) {
    if (!point.believed || point.beyond_best > point.standard_error) continue;
    choice.rank = point.rank;
    choice.strength = point.strength;
    break;
  }
  return choice;
}

}  // namespace knee_robot::identification
