#include "repeats.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kSame_m = 1e-4;
constexpr double kShortest_s = 2.0;
constexpr double kTravel_m = 0.005;
constexpr double kWholeCycle = 0.95;  ///< share of the lag that must come again without a break
constexpr double kWhole = 0.9;        ///< share of the longer recording that another one must repeat
constexpr double kSamePeriod = 1e-6;
constexpr double kAsGood = 0.98;  ///< of the longest match: a shorter lag is preferred
constexpr int kLooked = 1500;     ///< samples that every lag is tried on

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

/// First sample at which a reference has left its start.
int firstMotion(const OnGrid& g) {
  for (Eigen::Index n = 0; n < g.reference_m.rows(); ++n)
    if ((g.reference_m.row(n) - g.reference_m.row(0)).cwiseAbs().maxCoeff() > kSame_m) return static_cast<int>(n);
  return 0;
}

/// The run in which b is `lag` samples behind a, and how far they are apart (rms, in what they may be).
RepeatedRun runAt(const OnGrid& a, const OnGrid& b, int lag, double& apart) {
  RepeatedRun run = {std::max(0, -lag), std::max(0, lag), 0};
  const int rows_a = static_cast<int>(a.reference_m.rows()), rows_b = static_cast<int>(b.reference_m.rows());
  run.samples = std::min(rows_a - run.first_a, rows_b - run.first_b);
  if (run.samples < kWhole * std::max(rows_a, rows_b)) return {};
  const auto of = [&](const Eigen::MatrixXd& m, int first) { return m.middleRows(first, run.samples); };
  const double root = std::sqrt(static_cast<double>(run.samples * a.reference_m.cols()));
  const double may_be_m = kSame_m + of(a.half_step_m, run.first_a).norm() / root;
  apart = (of(a.reference_m, run.first_a) - of(b.reference_m, run.first_b)).norm() / root / may_be_m;
  return apart < 1.0 ? run : RepeatedRun();
}

}  // namespace

RepeatedRun findRepeatedRun(const recording::Recording& a, const recording::Signals& on_a,
                            const recording::Recording& b, const recording::Signals& on_b) {
  if (a.reference_m.cols() == 0 || a.reference_m.cols() != b.reference_m.cols()) return {};
  if (std::abs(on_a.period_s - on_b.period_s) > kSamePeriod * on_a.period_s) return {};
  const OnGrid grid_a = onGrid(a, on_a), grid_b = onGrid(b, on_b);
  const int lag = firstMotion(grid_b) - firstMotion(grid_a);
  RepeatedRun best;
  double least = 1.0;
  for (const int tried : {0, lag, lag - 1, lag + 1}) {
    double apart = 1.0;
    const RepeatedRun run = runAt(grid_a, grid_b, tried, apart);
    if (run.samples == 0 || apart >= least) continue;
    best = run;
    least = apart;
  }
  return best;
}

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
