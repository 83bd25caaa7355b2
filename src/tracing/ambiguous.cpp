#include "ambiguous.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kTogether = 0.9;  ///< correlation of two positions above which they are not told apart
constexpr double kClearly = 2.0;   ///< standard errors by which the one must explain more than the other
constexpr double kWorseBy = 1.2;   ///< and the factor of the held-back squares

double correlation(const std::vector<identification::Observation>& recordings, int a, int b) {
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (const identification::Observation& o : recordings) {
    const Eigen::ArrayXd x = o.signals.position_m.col(a).array() - o.signals.position_m.col(a).mean();
    const Eigen::ArrayXd y = o.signals.position_m.col(b).array() - o.signals.position_m.col(b).mean();
    aa += x.square().sum();
    bb += y.square().sum();
    ab += (x * y).sum();
  }
  return ab / std::sqrt(std::max(1e-300, aa * bb));
}

/// The recordings with position `own` replaced by what position `other` says about it.
std::vector<identification::Observation> asSeenFrom(const TraceData& data, int own, int other) {
  double xx = 0.0, xy = 0.0, n = 0.0, x = 0.0, y = 0.0;
  for (const identification::Observation& o : data.recordings) {
    const auto from = o.signals.position_m.col(other).array(), to = o.signals.position_m.col(own).array();
    xx += from.square().sum();
    xy += (from * to).sum();
    x += from.sum();
    y += to.sum();
    n += static_cast<double>(o.samples());
  }
  const double slope = (xy - x * y / n) / std::max(1e-300, xx - x * x / n), start = (y - slope * x) / n;
  std::vector<identification::Observation> out = data.recordings;
  for (identification::Observation& o : out)
    o.signals.position_m.col(own) = start + slope * o.signals.position_m.col(other).array();
  return out;
}

/// Does the effect explain the training data clearly better with its own position than with the one that went with it?
/// Both are fitted with everything else; compared block by block.
bool clearlyOwn(const Search& s, std::size_t effect, int own, int other) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  std::vector<Eigen::MatrixXd> rows = effectRows(*s.data, all);
  const Eigen::VectorXd mine = JointProblem(*s.data, *s.base, s.rms_N, all, rows).heldBack();
  const std::vector<identification::Observation> seen = asSeenFrom(*s.data, own, other);
  std::vector<EffectInput> inputs = s.data->inputs;
  for (std::size_t r = 0; r < inputs.size(); ++r)
    inputs[r].observation = &seen[r];
  inputs.swap(s.data->inputs);
  rows[effect] = effectRows(*s.data, all[effect]);
  inputs.swap(s.data->inputs);
  const Eigen::VectorXd theirs = JointProblem(*s.data, *s.base, s.rms_N, all, std::move(rows)).heldBack();
  const Eigen::VectorXd worse = theirs - mine;
  return worse.mean() > kClearly * standardError(worse) && theirs.sum() > kWorseBy * mine.sum();
}

}  // namespace

void holdBackAmbiguous(Search& s, std::vector<std::string>& notes) {
  const TraceData& data = *s.data;
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    FoundEffect& e = s.effects[k];
    const int own = e.hypothesis.place.candidate->positionOf(e.hypothesis.place.actuator);
    if (own < 0 || !data.recordings.front().motion.coupled) continue;
    for (int other = 0; other < data.stack.axes && e.transfers; ++other) {
      const double together = other == own ? 0.0 : correlation(data.recordings, own, other);
      if (std::abs(together) < kTogether || clearlyOwn(s, k, own, other)) continue;
      e.transfers = false;
      notes.push_back(e.hypothesis.place.candidate->name() + " on actuator " +
                      std::to_string(e.hypothesis.place.actuator + 1) + ": in training position " +
                      std::to_string(own + 1) + " went with position " + std::to_string(other + 1) + " (correlation " +
                      shortNumber(together, 2) +
                      ") and explains as much, so that which of them it depends on is not known; it is left out of "
                      "predictions elsewhere.");
    }
  }
}

}  // namespace knee_robot::tracing
