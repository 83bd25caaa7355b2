#include "held_back.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "one_path.h"
#include "refit.h"
#include "stretches.h"

namespace knee_robot::tracing {
namespace {

void labelByPath(const std::vector<int>& path_of, Stack& stack) {
  for (Pick& pick : stack.picks)
    pick.block = path_of[pick.recording];
  stack.blocks = 1 + *std::max_element(path_of.begin(), path_of.end());
}

/// What is predicted elsewhere (numbers of the search's effects), and what happened once, which both sides of a
/// comparison have.
struct Predicted {
  std::vector<std::size_t> effects;
  std::vector<Hypothesis> hypotheses, local;
};

Predicted predictedOf(const Search& s) {
  Predicted p;
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const Hypothesis& h = s.effects[k].hypothesis;
    if (h.place.candidate->local()) {
      p.local.push_back(h);
    } else if (isPredicted(s.effects[k])) {
      p.effects.push_back(k);
      p.hypotheses.push_back(h);
    }
  }
  return p;
}

/// Rows of an effect without what is each recording's own (how warm it began): of a path that was left out nobody knows
/// it, and without another path it cannot be told from the rest.
Eigen::MatrixXd rowsElsewhere(const TraceData& data, const Hypothesis& h) {
  const Eigen::MatrixXd rows = effectRows(data, h);
  if (!h.place.candidate->goesWithTime()) return rows;
  const Eigen::VectorXd kept = h.place.candidate->elsewhere(Eigen::VectorXd::Ones(rows.cols()));
  const Eigen::Index common = (kept.array() != 0.0).count();  // they come first
  return common > 0 ? rows.leftCols(common).eval() : rows;
}

JointProblem problemOfPaths(const Search& s, const std::vector<Hypothesis>& effects, const Eigen::VectorXd& noise_N) {
  std::vector<Eigen::MatrixXd> rows;
  for (const Hypothesis& h : effects)
    rows.push_back(rowsElsewhere(*s.data, h));
  return JointProblem(*s.data, *s.base, noise_N, effects, std::move(rows));
}

/// Shares of the baseline's squares on paths that were left out: what all effects save together, and each beside the
/// others.
struct SavedOnPaths {
  double together = 0.0;
  Eigen::ArrayXd each;
};

SavedOnPaths savedOnPaths(Search& s, const BaseFit& baseline, const Predicted& p, Attention attention) {
  s.attention = attention;
  setAttention(*s.data, attention);
  const double before = std::max(1e-300, baselineLeaves(s, baseline, p.local, s.rms_N, heldBackPaths).sum());
  std::vector<Hypothesis> all = p.hypotheses;
  all.insert(all.end(), p.local.begin(), p.local.end());
  const Stack own = s.data->stack;
  labelByPath(pathsOf(s.data->recordings), s.data->stack);
  const JointProblem problem = problemOfPaths(s, all, s.rms_N);
  const double with = problem.heldBack().sum();
  SavedOnPaths saved = {(before - with) / before, Eigen::ArrayXd(static_cast<Eigen::Index>(p.effects.size()))};
  inParallel(p.effects.size(), [&](std::size_t k) {
    saved.each[static_cast<Eigen::Index>(k)] = (problem.heldBackWithout(k).sum() - with) / before;
  });
  s.data->stack = own;
  return saved;
}

/// Changes of squares that are the negative of these shares saved.
std::string changes(double moving, double all) {
  const auto change = [](double saved) {
    return (saved < 0.0 ? "+" : "-") + shortNumber(100.0 * std::abs(saved), 2) + " %";
  };
  return "squares while axes move " + change(moving) + ", of all samples " + change(all);
}

/// The number of the effect that speaks most against itself, beside the others or, where all together harm, by the sum
/// of what it saves. -1: none.
Eigen::Index mostHarmful(const SavedOnPaths& moving, const SavedOnPaths& all, const Predicted& p, bool together) {
  const Eigen::ArrayXd sum = moving.each + all.each;
  Eigen::Index worst = -1;
  for (Eigen::Index k = 0; k < sum.size(); ++k) {
    const bool field = p.hypotheses[static_cast<std::size_t>(k)].place.candidate->isForceField();
    const bool harms = harmsElsewhere(moving.each[k], all.each[k], field) || (together && sum[k] < 0.0);
    if (harms && (worst < 0 || sum[k] < sum[worst])) worst = k;
  }
  return worst;
}

/// One round: what is left out, and why; empty: all that is predicted may stay.
std::string leaveOutOne(Search& s, const BaseFit& baseline, const Predicted& p) {
  const SavedOnPaths moving = savedOnPaths(s, baseline, p, Attention::Moving);
  const SavedOnPaths all = savedOnPaths(s, baseline, p, Attention::All);
  const bool together = moving.together < 0.0 || all.together < 0.0;
  const Eigen::Index worst = mostHarmful(moving, all, p, together);
  if (worst >= 0) {
    FoundEffect& e = s.effects[p.effects[static_cast<std::size_t>(worst)]];
    e.transfers = false;
    return placeText(e.hypothesis.place) +
           ": fitted without one of the paths it makes the error along that path larger (" +
           changes(moving.each[worst], all.each[worst]) + "); it is left out of predictions elsewhere.";
  }
  if (!together) return {};
  for (const std::size_t k : p.effects)
    s.effects[k].transfers = false;
  return "Fitted without one of the paths the model with what was found predicts that path worse than the baseline "
         "does (" +
         changes(moving.together, all.together) + "); it is left out of predictions elsewhere.";
}

}  // namespace

Eigen::VectorXd heldBackPositions(Search& s, const std::vector<Hypothesis>& effects, const Eigen::VectorXd& noise_N) {
  const Stack own = s.data->stack;
  const std::vector<Eigen::MatrixXd> rows = effectRows(*s.data, effects);
  Eigen::VectorXd left(2 * kStretches);
  for (const int direction : {0, 1}) {
    labelByPosition(s.data->recordings, direction, s.data->stack);
    left.segment(direction * kStretches, kStretches) =
        JointProblem(*s.data, *s.base, noise_N, effects, rows).heldBack();
  }
  s.data->stack = own;
  return left;
}

Eigen::VectorXd heldBackPaths(Search& s, const std::vector<Hypothesis>& effects, const Eigen::VectorXd& noise_N) {
  const Stack own = s.data->stack;
  labelByPath(pathsOf(s.data->recordings), s.data->stack);
  const Eigen::VectorXd left = problemOfPaths(s, effects, noise_N).heldBack();
  s.data->stack = own;
  return left;
}

Eigen::VectorXd baselineLeaves(Search& s, const BaseFit& baseline, const std::vector<Hypothesis>& local,
                               const Eigen::VectorXd& noise_N, HeldBack held_back) {
  TraceData& data = *s.data;
  BaseFit newtons = inNewtons(baseline);
  for (identification::Observation& o : data.recordings)
    identification::setFriction(o, baseline.columns, baseline.friction_laws);
  const Eigen::MatrixXd rows = data.all_base_rows;
  data.all_base_rows = baseRows(newtons, data.recordings, data.stack);
  setAttention(data, s.attention);
  BaseFit* const now = s.base;
  s.base = &newtons;
  const Eigen::VectorXd left = held_back(s, local, noise_N);
  s.base = now;
  data.all_base_rows = rows;
  setAttention(data, s.attention);
  for (identification::Observation& o : data.recordings)
    identification::setFriction(o, s.base->columns, s.base->friction_laws);
  return left;
}

bool harmsElsewhere(double moving, double all, bool force_field) {
  return force_field ? moving < 0.0 || all < 0.0 : moving < 0.0 && all < 0.0;
}

bool isPredicted(const FoundEffect& e) {
  return e.transfers && e.hypothesis.place.candidate->elsewhere(e.coefficients).size() > 0;
}

void holdBackOfPaths(Search& s, const BaseFit& baseline, std::vector<std::string>& notes) {
  const std::vector<int> path_of = pathsOf(s.data->recordings);
  if (*std::max_element(path_of.begin(), path_of.end()) == 0) return;
  const Attention own = s.attention;
  for (Predicted p = predictedOf(s); !p.effects.empty(); p = predictedOf(s)) {
    const std::string why = leaveOutOne(s, baseline, p);
    if (why.empty()) break;
    notes.push_back(why);
  }
  s.attention = own;
  setAttention(*s.data, own);
}

}  // namespace knee_robot::tracing
