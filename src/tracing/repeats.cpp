#include "repeats.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kSame_m = 1e-4;
constexpr double kShortest_s = 2.0;
constexpr double kTravel_m = 0.005;
constexpr double kWholeCycle = 0.95;  ///< share of the lag that must come again without a break
constexpr double kAsGood = 0.98;      ///< of the longest match: a shorter lag is preferred
constexpr int kLooked = 1500;         ///< samples that every lag is tried on

/// The reference at the samples of the grid, and how far it moves in half a sample.
struct OnGrid {
  Eigen::MatrixXd reference_m, half_step_m;
};

OnGrid onGrid(const recording::Recording& r, const recording::Signals& s) {
  OnGrid g;
  g.reference_m.resize(s.samples(), r.reference_m.cols());
  std::size_t row = 0;
  for (int n = 0; n < s.samples(); ++n) {
    const double t = s.time_s[static_cast<std::size_t>(n)];
    while (row + 2 < r.time_s.size() && r.time_s[row + 1] <= t)
      ++row;
    const double part = std::clamp((t - r.time_s[row]) / (r.time_s[row + 1] - r.time_s[row]), 0.0, 1.0);
    const Eigen::Index at = static_cast<Eigen::Index>(row);
    g.reference_m.row(n) = (1.0 - part) * r.reference_m.row(at) + part * r.reference_m.row(at + 1);
  }
  g.half_step_m = Eigen::MatrixXd::Zero(s.samples(), r.reference_m.cols());
  for (int n = 0; n + 1 < s.samples(); ++n)
    g.half_step_m.row(n) = 0.5 * (g.reference_m.row(n + 1) - g.reference_m.row(n)).cwiseAbs();
  return g;
}

bool same(const OnGrid& g, int n, int lag) {
  for (Eigen::Index i = 0; i < g.reference_m.cols(); ++i) {
    if (std::abs(g.reference_m(n + lag, i) - g.reference_m(n, i)) > kSame_m + g.half_step_m(n, i)) return false;
  }
  return true;
}

/// Samples of runs that last a whole cycle and travel; looks at every `stride`-th sample.
std::vector<int> matches(const OnGrid& g, int lag, int stride) {
  const int count = static_cast<int>(g.reference_m.rows());
  std::vector<int> all, run;
  const auto close = [&] {
    if (!run.empty() && run.back() - run.front() + stride >= kWholeCycle * lag) {
      const auto cycle = g.reference_m.middleRows(run.front(), std::min(lag, run.back() - run.front() + 1));
      const double travel = (cycle.colwise().maxCoeff() - cycle.colwise().minCoeff()).maxCoeff();
      if (travel >= kTravel_m) all.insert(all.end(), run.begin(), run.end());
    }
    run.clear();
  };
  for (int n = 0; n + lag < count; n += stride) {
    if (same(g, n, lag)) {
      run.push_back(n);
    } else {
      close();
    }
  }
  close();
  return all;
}

}  // namespace

RepeatedCycle findRepeatedCycle(const recording::Recording& recording, const recording::Signals& signals) {
  RepeatedCycle best;
  if (recording.reference_m.cols() == 0 || recording.rows() < 3) return best;
  const OnGrid g = onGrid(recording, signals);
  const int stride = std::max(1, signals.samples() / kLooked);
  std::size_t most = 0;
  for (int lag = static_cast<int>(kShortest_s / signals.period_s); lag <= signals.samples() / 2 + stride; ++lag) {
    const std::size_t found = matches(g, lag, stride).size();
    if (static_cast<double>(found) * kAsGood <= static_cast<double>(most)) continue;
    most = found;
    best.lag = lag;
  }
  if (most == 0) return {};
  best.first = matches(g, best.lag, 1);
  return best.first.empty() ? RepeatedCycle() : best;
}

}  // namespace knee_robot::tracing
