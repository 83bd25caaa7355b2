#include "knee_robot/tracing/given_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "given_search.h"
#include "knee_robot/base/errors.h"
#include "model_effects.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNoChange = 0.05;    ///< of an effect: its standard error knows nothing of the baseline beside it
constexpr double kAgree = 2.0;        ///< standard errors within which a single coefficient is the same
constexpr double kLeastShare = 1e-3;  ///< of held-back squares: less is rounding, or a coefficient at its bound
constexpr double kSameSize =
    1.5;  ///< ratio of the forces' rms within which an effect with several coefficients is the same

struct Gain {
  double share = 0.0, share_error = 0.0;  ///< of the squares that held-back blocks leave without the effect
  Eigen::VectorXd explained_rms_N;
};

/// What effect k saves beside the others; `with`: the fit of all.
Gain gainOf(const Search& s, const JointFit& with, std::size_t k) {
  std::vector<Hypothesis> others = hypothesesOf(s.effects);
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  const JointFit without = fitOf(s, others);
  const Eigen::VectorXd saved = without.held_back - with.held_back;
  const double n = static_cast<double>(saved.size()), left = without.held_back.sum();
  Gain g{n * saved.mean() / left, n * standardError(saved) / left, Eigen::VectorXd(s.data->stack.axes)};
  const Eigen::Index rows = s.data->stack.size();
  for (int i = 0; i < s.data->stack.axes; ++i) {
    const double square = without.residual_N.segment(i * rows, rows).squaredNorm() -
                          with.residual_N.segment(i * rows, rows).squaredNorm();
    g.explained_rms_N[i] = std::sqrt(std::max(0.0, square / static_cast<double>(rows)));
  }
  return g;
}

/// Whether the refitted effect is the given one, as far as the two can be told apart.
bool agrees(const Search& s, const FoundEffect& given, const FoundEffect& now) {
  if (now.coefficients.size() == 1) {
    const auto known = [](double std) { return std::isfinite(std) ? std : 0.0; };
    const double told_apart = std::max(kAgree * std::hypot(known(now.std[0]), known(given.std[0])),
                                       kNoChange * std::abs(given.coefficients[0]));
    return std::abs(now.coefficients[0] - given.coefficients[0]) <= told_apart;
  }
  if (now.coefficients.size() != given.coefficients.size()) return true;  // fitted per recording: nothing to compare
  const Eigen::MatrixXd rows = effectRows(*s.data, now.hypothesis);
  const double ratio = (rows * now.coefficients).norm() / std::max(1e-300, (rows * given.coefficients).norm());
  return ratio < kSameSize && ratio > 1.0 / kSameSize;
}

std::vector<dynamics::EffectParameter> refitted(const FoundEffect& e, const EffectInput& input) {
  std::vector<dynamics::EffectParameter> out;
  const std::vector<Coefficient> names = e.hypothesis.place.candidate->coefficients(input);
  for (std::size_t k = 0; k < names.size(); ++k)
    out.push_back({names[k].name, e.coefficients[static_cast<Eigen::Index>(k)], e.std[static_cast<Eigen::Index>(k)]});
  return out;
}

void compareParameters(const Search& s, const StartModel& start, GivenModel& report) {
  const BaseFit& base = *s.base;
  std::vector<double> values;
  for (const dynamics::ModelParameter& p : start.model.parameters)
    values.push_back(p.value);
  const Eigen::VectorXd given = inColumns(start.model, values, base.columns);
  for (int k = 0; k < base.bounded; ++k) {
    Eigen::Index c = 0;
    const double unit = base.basis.col(k).cwiseAbs().maxCoeff(&c);
    const identification::Column& column = base.columns[static_cast<std::size_t>(c)];
    report.parameters.push_back({column.name, column.unit, given[c], unit * s.fit.base[k], unit * s.fit.base_std[k]});
  }
}

}  // namespace

Eigen::VectorXd startParameters(const StartModel& given, const std::vector<identification::Column>& columns) {
  std::vector<double> values;
  for (const dynamics::ModelParameter& p : given.model.parameters) {
    values.push_back(p.value);
    const bool known =
        std::any_of(columns.begin(), columns.end(), [&](const identification::Column& c) { return c.name == p.name; });
    if (known || p.value == 0.0) continue;
    throw InputError(given.path + ": has the parameter " + p.name +
                     ", which the baseline of trace does not have; identify without the joints' friction");
  }
  return inColumns(given.model, values, columns);
}

GivenModel startFrom(const mechanism::Robot& robot, const StartModel& start, const CandidateList& named,
                     CandidateList& maps, Search& s) {
  GivenModel report;
  report.path = start.path;
  const int recordings = static_cast<int>(start.model.data.size());
  std::vector<FoundEffect> given;     // of those in s.effects, in order
  std::vector<std::size_t> reported;  // where
  for (const dynamics::ModelEffect& m : start.model.effects) {
    report.effects.push_back({m, false, "belongs to its own recordings", {}, 0.0, 0.0});
    const FoundEffect e = effectOf(robot, m, recordings, start.path, named, maps);
    const Candidate& candidate = *e.hypothesis.place.candidate;
    if (candidate.shared() && !(candidate.transfers() && candidate.knownElsewhere())) continue;
    addEffect(given, e);
    reported.push_back(report.effects.size() - 1);
  }
  s.effects = given;
  for (FoundEffect& e : s.effects)
    e.p = std::numeric_limits<double>::quiet_NaN();  // its evidence is another recording's
  refit(s);
  for (bool changed = true; changed;) {
    changed = false;
    std::size_t worst = 0;
    double least = std::numeric_limits<double>::infinity();
    const JointFit with = fitOf(s, hypothesesOf(s.effects));
    for (std::size_t k = 0; k < s.effects.size(); ++k) {
      const Gain g = gainOf(s, with, k);
      FoundEffect& e = s.effects[k];
      e.gain = g.share;
      e.gain_error = g.share_error;
      e.explained_rms_N = g.explained_rms_N;
      e.null_rms_N = Eigen::VectorXd::Constant(g.explained_rms_N.size(), std::numeric_limits<double>::quiet_NaN());
      GivenEffect& r = report.effects[reported[k]];
      r.gain = g.share;
      r.gain_error = g.share_error;
      r.now = refitted(e, s.data->inputs.front());
      r.kept = true;
      r.verdict = agrees(s, given[k], e) ? "still holds" : "has changed";
      const double sure = g.share < kLeastShare ? std::min(-1e-9, g.share) : g.share - g.share_error;
      if (sure >= std::min(least, 0.0)) continue;
      least = sure;
      worst = k;
      changed = true;
    }
    if (!changed) break;
    report.effects[reported[worst]].kept = false;
    report.effects[reported[worst]].verdict = "is not needed here";
    const auto at = static_cast<std::ptrdiff_t>(worst);
    s.effects.erase(s.effects.begin() + at);
    given.erase(given.begin() + at);
    reported.erase(reported.begin() + at);
    refit(s);
  }
  compareParameters(s, start, report);
  return report;
}

}  // namespace knee_robot::tracing
