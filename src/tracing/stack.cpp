#include "knee_robot/tracing/stack.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/recording/filter.h"

namespace knee_robot::tracing {
namespace {

constexpr double kRest = 0.1;   ///< weight at rest
constexpr double kReach = 0.6;  ///< of the low-pass, in periods of the cut-off
constexpr int kTraceBlocks = 12;
constexpr double kSamplesPerCutoff =
    6.0;  ///< the low-passed signals hold about two independent values per cut-off period,
constexpr double kFewestPerCutoff = 3.0;  ///< so that these are enough, where more would be
constexpr double kEnough_hz = 30.0;
constexpr double kMostRows =
    4e4;  ///< of all actuators: a longer recording is thinned, its candidates' columns would fill the memory

double totalSpeed(const identification::Observation& o, int sample) {
  return o.signals.velocity_m_per_s.row(sample).cwiseAbs().sum();
}

/// First samples of the pieces of a recording, moved to the slowest sample nearby.
std::vector<int> cuts(const identification::Observation& o, int pieces) {
  std::vector<int> out;
  const double length = static_cast<double>(o.samples()) / pieces;
  for (int k = 1; k < pieces; ++k) {
    const int from = static_cast<int>((k - 0.2) * length), to = static_cast<int>((k + 0.2) * length);
    int slowest = from;
    for (int n = from; n < to; ++n) {
      if (totalSpeed(o, n) < totalSpeed(o, slowest)) slowest = n;
    }
    out.push_back(slowest);
  }
  return out;
}

bool nearRest(const identification::Observation& o, int sample, int actuator, double reach_s) {
  const int reach = static_cast<int>(reach_s / o.signals.period_s);
  for (int n = std::max(0, sample - reach); n <= std::min(o.samples() - 1, sample + reach); ++n) {
    if (!o.axis_moving(n, actuator)) return true;
  }
  return false;
}

}  // namespace

Stack makeStack(const std::vector<identification::Observation>& recordings,
                const identification::ObservationOptions& options) {
  Stack stack;
  stack.axes = recordings.front().axes();
  stack.cutoff_hz = options.cutoff_hz;
  stack.most_rows = options.most_rows;
  const double rate_hz =
      std::min(kSamplesPerCutoff * options.cutoff_hz, std::max(kEnough_hz, kFewestPerCutoff * options.cutoff_hz));
  double total = 0.0, rows = 0.0;
  for (const identification::Observation& o : recordings) {
    total += o.samples();
    rows += stack.axes * rate_hz * o.signals.period_s * o.samples();
  }
  const double thinner = std::max(1.0, rows / kMostRows);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const identification::Observation& o = recordings[r];
    const int stride = std::max(1, static_cast<int>(std::floor(thinner / (rate_hz * o.signals.period_s))));
    stack.rate_hz = 1.0 / (stride * o.signals.period_s);
    const int pieces = std::max(1, static_cast<int>(std::lround(kTraceBlocks * o.samples() / total)));
    const std::vector<int> ends = cuts(o, pieces);
    for (int n = 0; n < o.samples(); n += stride) {
      if (!o.usable[static_cast<std::size_t>(n)]) continue;
      const int piece = static_cast<int>(std::upper_bound(ends.begin(), ends.end(), n) - ends.begin());
      stack.picks.push_back({r, n, stack.blocks + piece});
    }
    stack.blocks += pieces;
  }
  return stack;
}

Eigen::VectorXd rowScale(const Stack& stack, const std::vector<identification::Observation>& recordings,
                         Attention attention) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(stack.size() * stack.axes);
  if (attention == Attention::All) return scale;
  for (int i = 0; i < stack.axes; ++i) {
    auto own = scale.segment(i * stack.size(), stack.size());
    for (Eigen::Index k = 0; k < stack.size(); ++k) {
      const Pick& pick = stack.picks[static_cast<std::size_t>(k)];
      if (nearRest(recordings[pick.recording], pick.sample, i, kReach / stack.cutoff_hz)) own[k] = kRest;
    }
    own /= std::max(kRest, own.norm() / std::sqrt(static_cast<double>(stack.size())));
  }
  return scale;
}

Eigen::MatrixXd gather(const Stack& stack, const std::vector<identification::Observation>& recordings,
                       std::vector<Eigen::MatrixXd> columns) {
  for (std::size_t r = 0; r < recordings.size(); ++r)
    recording::ZeroPhaseLowPass(stack.cutoff_hz, 1.0 / recordings[r].signals.period_s).applyToColumns(columns[r]);
  Eigen::MatrixXd out(stack.size(), columns.front().cols());
  for (Eigen::Index c = 0; c < out.cols(); ++c) {  // column by column, as they lie in memory
    for (Eigen::Index k = 0; k < stack.size(); ++k) {
      const Pick& pick = stack.picks[static_cast<std::size_t>(k)];
      out(k, c) = columns[pick.recording](pick.sample, c);
    }
  }
  return out;
}

Eigen::VectorXd gatherForce(const Stack& stack, const std::vector<identification::Observation>& recordings,
                            int actuator) {
  Eigen::VectorXd out(stack.size());
  for (Eigen::Index k = 0; k < stack.size(); ++k) {
    const Pick& pick = stack.picks[static_cast<std::size_t>(k)];
    out[k] = recordings[pick.recording].force_filtered_N(pick.sample, actuator);
  }
  return out;
}

}  // namespace knee_robot::tracing
