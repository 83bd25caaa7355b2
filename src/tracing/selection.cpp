#include "selection.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

constexpr Eigen::Index kSignTestBlocks = 10;  ///< chance that all gain: one of 1024
constexpr double kSignTestErrors = 3.0;       ///< of a normal variable, that chance

}  // namespace

double standardError(const Eigen::VectorXd& values) {
  const double n = static_cast<double>(values.size());
  return std::sqrt((values.array() - values.mean()).square().sum() / (n * (n - 1.0)));
}

HeldBackGain heldBackGain(const Eigen::VectorXd& per_block) {
  HeldBackGain g;
  g.mean = per_block.mean();
  g.error = standardError(per_block);
  g.gaining = (per_block.array() > 0.0).cast<double>().mean();
  if (g.gaining == 1.0 && per_block.size() >= kSignTestBlocks) g.error = std::min(g.error, g.mean / kSignTestErrors);
  return g;
}

double probabilityPositive(const Eigen::VectorXd& difference) {
  const HeldBackGain g = heldBackGain(difference);
  return 0.5 * std::erfc(-g.mean / std::max(1e-300, g.error) / std::sqrt(2.0));
}

double MaxNull::p(Eigen::Index place, double root) const {
  const auto reached = largest.end() - std::lower_bound(largest.begin(), largest.end(), standardized(place, root));
  return (1.0 + static_cast<double>(reached)) / (1.0 + static_cast<double>(largest.size()));
}

MaxNull maxNull(const Eigen::MatrixXd& roots, double worthwhile, double least_spread) {
  MaxNull null;
  null.mean = roots.rowwise().mean();
  null.spread = ((roots.colwise() - null.mean).rowwise().squaredNorm() / static_cast<double>(roots.cols() - 1))
                    .cwiseSqrt()
                    .cwiseMax(least_spread);
  for (Eigen::Index d = 0; d < roots.cols(); ++d) {
    double largest = 0.0;
    for (Eigen::Index place = 0; place < roots.rows(); ++place) {
      if (roots(place, d) >= worthwhile) largest = std::max(largest, null.standardized(place, roots(place, d)));
    }
    null.largest.push_back(largest);
  }
  std::sort(null.largest.begin(), null.largest.end());
  return null;
}

namespace {

/// One pass; true when something was added.
bool addOne(SelectionProblem& problem, double largest_p, std::vector<std::string>& rejected) {
  const std::vector<SelectionTrial> trials = problem.compare();
  const auto passes = [](const SelectionTrial& t) { return t.objection.empty(); };
  for (const SelectionTrial& t : trials) {
    if (!passes(t)) rejected.push_back(t.name + ": " + t.objection);
  }
  if (std::none_of(trials.begin(), trials.end(), passes)) return false;
  const MaxNull null = problem.null();
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (!passes(trials[k])) continue;
    const double p = null.p(trials[k].place, trials[k].root);
    if (p <= largest_p) return problem.accept(k, null, p);
    rejected.push_back(trials[k].name + ": surrogates explain as much by chance (p = " + shortNumber(p, 2) + ")");
  }
  return false;
}

}  // namespace

int selectForward(SelectionProblem& problem, int most, double largest_p, std::vector<std::string>& rejected) {
  int added = 0;
  while (added < most) {
    rejected.clear();  // only why the search ended is of interest
    if (!addOne(problem, largest_p, rejected)) break;
    ++added;
  }
  return added;
}

}  // namespace knee_robot::tracing
