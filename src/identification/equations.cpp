#include "knee_robot/identification/equations.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knee_robot/recording/filter.h"
#include "places.h"

namespace knee_robot::identification {
namespace {

constexpr double kFilesApart_s = 1e6;

/// One sample that is used, of one training file.
struct Pick {
  std::size_t file;
  int sample;
  int run;  ///< number of the contiguous stretch
  int block = 0;
};

constexpr double kReversalReach = 0.6;  ///< of the low-pass, in periods of the cut-off: so far a reversal is seen

bool movesAt(const Observation& o, int sample, bool independent) {
  return independent ? o.axis_moving.row(sample).any() : o.moving[static_cast<std::size_t>(sample)] != 0;
}

/// Per sample: the actuator rests, or does so within the filter's reach.
std::vector<char> nearRest(const Observation& o, int actuator, double reach_s) {
  const int reach = static_cast<int>(reach_s / o.signals.period_s);
  std::vector<char> near(static_cast<std::size_t>(o.samples()), 0);
  int last = -reach - 1;  // the last sample at rest
  for (int n = 0; n < o.samples(); ++n) {
    if (!o.axis_moving(n, actuator)) last = n;
    if (n - last <= reach) near[static_cast<std::size_t>(n)] = 1;
  }
  last = o.samples() + reach;
  for (int n = o.samples() - 1; n >= 0; --n) {
    if (!o.axis_moving(n, actuator)) last = n;
    if (last - n <= reach) near[static_cast<std::size_t>(n)] = 1;
  }
  return near;
}

/// Of the samples that are used, from one to the next.
int strideOf(const Observation& o, const ObservationOptions& options, double thinner) {
  return std::max(1, static_cast<int>(std::floor(thinner / (10.0 * options.cutoff_hz * o.signals.period_s))));
}

/// Factor by which samples are thinned beyond ten a period of the cut-off.
double thinnerOf(const std::vector<Observation>& training, const ObservationOptions& options) {
  if (options.most_rows <= 0) return 1.0;
  double rows = 0.0;
  for (const Observation& o : training)
    rows += static_cast<double>(o.axes()) * o.samples() / strideOf(o, options, 1.0);
  return std::max(1.0, rows / options.most_rows);
}

/// Runs of consecutive usable samples in which the robot moves, or in which it does not, in the order of the files.
std::vector<std::vector<Pick>> findRuns(const std::vector<Observation>& training, const ObservationOptions& options,
                                        bool independent) {
  std::vector<std::vector<Pick>> runs;
  const double thinner = thinnerOf(training, options);
  for (std::size_t f = 0; f < training.size(); ++f) {
    const int stride = strideOf(training[f], options, thinner);
    int before = -1;  // 0: rests, 1: moves, -1: not usable
    for (int n = 0; n < training[f].samples(); ++n) {
      const int now = training[f].usable[static_cast<std::size_t>(n)] ? movesAt(training[f], n, independent) : -1;
      if (now >= 0 && now != before) runs.emplace_back();
      before = now;
      if (now >= 0 && n % stride == 0) runs.back().push_back({f, n, static_cast<int>(runs.size())});
    }
  }
  return runs;
}

std::vector<Pick> findPicks(const std::vector<Observation>& training, const ObservationOptions& options,
                            bool independent) {
  std::vector<Pick> picks;
  for (const std::vector<Pick>& run : findRuns(training, options, independent))
    picks.insert(picks.end(), run.begin(), run.end());
  return picks;
}

/// Per pick the first one at the same place of another run.
std::vector<int> firstVisitsOf(const std::vector<Observation>& training, const std::vector<Pick>& picks) {
  const int axes = training.front().axes();
  Eigen::MatrixXd state(static_cast<Eigen::Index>(picks.size()), 2 * axes);
  std::vector<int> run;
  for (std::size_t k = 0; k < picks.size(); ++k) {
    const recording::Signals& s = training[picks[k].file].signals;
    state.row(static_cast<Eigen::Index>(k)) << s.position_m.row(picks[k].sample),
        s.velocity_m_per_s.row(picks[k].sample);
    run.push_back(picks[k].run);
  }
  return firstVisits(state, run);
}

/// Numbers the blocks: whole runs are joined until a block has its share; a longer run is cut. Later visits of a place
/// go with the first one.
int assignBlocks(const std::vector<Observation>& training, std::vector<Pick>& picks) {
  if (picks.empty()) return 0;
  const std::vector<int> first = firstVisitsOf(training, picks);
  std::vector<int> visits(picks.size(), 0);
  for (const int place : first)
    ++visits[static_cast<std::size_t>(place)];
  const double share = std::max(1.0, static_cast<double>(picks.size()) / kBlocks);
  int block = 0, in_block = 0;
  const Pick* before = nullptr;  // last one that is the first at its place
  for (std::size_t k = 0; k < picks.size(); ++k) {
    if (visits[k] == 0) {
      picks[k].block = picks[static_cast<std::size_t>(first[k])].block;
      continue;
    }
    const bool new_run = before != nullptr && picks[k].run != before->run;
    const bool new_file = new_run && picks[k].file != before->file;
    const bool enough = new_run && (in_block >= 0.75 * share || (new_file && in_block > share / 2));
    if (in_block > 0 && (enough || in_block >= 1.5 * share)) {
      ++block;
      in_block = 0;
    }
    picks[k].block = block;
    in_block += visits[k];
    before = &picks[k];
  }
  return block + 1;
}

/// Low-passed columns of the regressor; filtering column by column keeps one filtered column in memory, not a second
/// regressor.
void fill(const std::vector<Observation>& training, const ObservationOptions& options, const std::vector<Pick>& picks,
          const std::vector<int>& columns, Equations& e) {
  std::vector<Eigen::VectorXd> filtered(training.size());
  for (const int c : columns) {
    Eigen::Index row = 0;
    for (int i = 0; i < e.axes; ++i) {
      for (std::size_t f = 0; f < training.size(); ++f) {
        const Observation& o = training[f];
        filtered[f] = o.regressor[static_cast<std::size_t>(i)].col(c);
        if (filtered[f].isZero(0.0)) continue;
        recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).apply(filtered[f]);
      }
      for (const Pick& p : picks)
        e.a(row++, c) = filtered[p.file][p.sample];
    }
  }
}

}  // namespace

Equations stackEquations(const std::vector<Observation>& training, const ObservationOptions& options) {
  Equations e;
  e.axes = training.front().axes();
  const bool independent = !training.front().motion.coupled;
  std::vector<Pick> picks = findPicks(training, options, independent);
  e.blocks = assignBlocks(training, picks);

  const int rows = static_cast<int>(picks.size()) * e.axes;
  const double thinner = thinnerOf(training, options);
  for (const Pick& p : picks) {
    if (movesAt(training[p.file], p.sample, independent))
      e.duration_s += training[p.file].signals.period_s * strideOf(training[p.file], options, thinner);
  }
  const Eigen::Index columns = training.front().regressor.front().cols();
  e.a.resize(rows, columns);
  e.b.resize(rows);
  e.step_s = training.front().signals.period_s * strideOf(training.front(), options, thinner);
  for (int i = 0; i < e.axes; ++i) {
    double elapsed = 0.0;
    std::size_t file = 0;
    std::vector<std::vector<char>> rest;
    for (const Observation& o : training)
      rest.push_back(nearRest(o, i, kReversalReach / options.cutoff_hz));
    for (const Pick& p : picks) {
      if (p.file != file) elapsed = kFilesApart_s * static_cast<double>(file = p.file);
      elapsed += e.step_s;
      e.actuator.push_back(i);
      e.file.push_back(p.file);
      e.sample.push_back(p.sample);
      e.rest.push_back(rest[p.file][static_cast<std::size_t>(p.sample)]);
      e.block.push_back(p.block);
      e.time_s.push_back(kFilesApart_s * static_cast<double>(p.file) + p.sample * training[p.file].signals.period_s);
      e.elapsed_s.push_back(elapsed);
    }
  }
  std::vector<int> all(static_cast<std::size_t>(columns));
  std::iota(all.begin(), all.end(), 0);
  fill(training, options, picks, all, e);
  Eigen::Index row = 0;
  for (int i = 0; i < e.axes; ++i) {
    for (const Pick& p : picks)
      e.b[row++] = training[p.file].force_filtered_N(p.sample, i);
  }
  return e;
}

void refillColumns(const std::vector<Observation>& training, const ObservationOptions& options,
                   const std::vector<int>& columns, Equations& e) {
  const bool independent = !training.front().motion.coupled;
  fill(training, options, findPicks(training, options, independent), columns, e);
}

void weightRows(Equations& e, const Eigen::VectorXd& noise_N) {
  Eigen::ArrayXd noise(e.rows());
  for (int row = 0; row < e.rows(); ++row) {
    const std::size_t at = static_cast<std::size_t>(row);
    const bool second = noise_N.size() > e.axes && e.rest[at];
    noise[row] = noise_N[e.actuator[at] + (second ? e.axes : 0)];
  }
  e.a.array().colwise() /= noise;
  e.b.array() /= noise;
}

Eigen::VectorXd noiseInMotionAndNearRest(const Equations& e, const Eigen::VectorXd& residual) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(2 * e.axes), count = sum;
  for (int row = 0; row < e.rows(); ++row) {
    const std::size_t at = static_cast<std::size_t>(row);
    const int class_of = e.actuator[at] + (e.rest[at] ? e.axes : 0);
    sum[class_of] += residual[row] * residual[row];
    count[class_of] += 1.0;
  }
  const double least = 1e-6 * std::max(1e-6, std::sqrt(residual.squaredNorm() / std::max(1, e.rows())));
  Eigen::VectorXd noise(2 * e.axes);
  for (int i = 0; i < e.axes; ++i) {
    const bool moves = count[i] > 0.0;
    const double all = std::sqrt((sum[i] + sum[e.axes + i]) / std::max(1.0, count[i] + count[e.axes + i]));
    noise[i] = std::max(least, moves ? std::sqrt(sum[i] / count[i]) : all);
    const double rest = count[e.axes + i] > 0.0 ? std::sqrt(sum[e.axes + i] / count[e.axes + i]) : all;
    noise[e.axes + i] = std::max(noise[i], rest);
  }
  return noise;
}

Eigen::MatrixXd atRows(const std::vector<Observation>& training, const ObservationOptions& options, const Equations& e,
                       int actuator, std::vector<Eigen::MatrixXd> signals) {
  for (std::size_t f = 0; f < training.size(); ++f)
    recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / training[f].signals.period_s).applyToColumns(signals[f]);
  const Eigen::Index each = e.rows() / e.axes;
  Eigen::MatrixXd out(each, signals.front().cols());
  for (Eigen::Index c = 0; c < out.cols(); ++c) {  // column by column, as they lie in memory
    for (Eigen::Index k = 0; k < each; ++k) {
      const std::size_t row = static_cast<std::size_t>(actuator * each + k);
      out(k, c) = signals[e.file[row]](e.sample[row], c);
    }
  }
  return out;
}

Eigen::VectorXd rmsPerActuator(const Equations& e, const Eigen::VectorXd& residual) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(e.axes);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(e.axes);
  for (int row = 0; row < e.rows(); ++row) {
    const int i = e.actuator[static_cast<std::size_t>(row)];
    sum[i] += residual[row] * residual[row];
    count[i] += 1.0;
  }
  return (sum.array() / count.array().max(1.0)).sqrt();
}

}  // namespace knee_robot::identification
