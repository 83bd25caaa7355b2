// What is predicted in other recordings: decided on held-back training data, at positions that were left out.

#include "elsewhere.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "held_back.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/trained_range.h"
#include "knee_robot/recording/filter.h"
#include "refit.h"
#include "selection.h"
#include "settle_laws.h"
#include "stretches.h"

namespace knee_robot::tracing {
namespace {

constexpr double kErrors = 1.0;        ///< standard errors by which an effect, and all of them together, must help
constexpr double kMovingErrors = 2.0;  ///< the same while axes move, where all samples alike do not show it surely

/// What is gained on held-back stretches: with samples near rest counting little, and with all alike.
struct Helps {
  HeldBackGain moving, all;

  /// Near rest friction may take any value, and most of what is left lies there: what clearly helps while axes move
  /// need not surely help in all samples, but help; and what helps in all samples must not surely harm while they move.
  /// A force that depends on the pose acts in motion as at rest: it has to help there, too.
  bool surely(bool force_field = false) const {
    const bool harms = force_field ? moving.mean <= 0.0 : moving.mean < -kErrors * moving.error;
    return (all.mean > kErrors * all.error && !harms) || (all.mean > 0.0 && moving.mean > kMovingErrors * moving.error);
  }
};

/// Squares (weighted, at the stack's rate) that a model with these effects leaves where the pose is masked: nothing was
/// fitted there.
double maskedSquares(const Search& s, const std::vector<Hypothesis>& effects) {
  const JointFit fit = fitOf(s, effects, LeftOut::None);
  const SurrogateModel model = {s.base->parametersOf(fit.base), effects, fit.coefficients};
  double sum = 0.0;
  for (const EffectInput& input : s.data->inputs) {
    const identification::Observation& o = *input.observation;
    if (std::count(o.motion.uncertain.begin(), o.motion.uncertain.end(), 1) == 0) continue;
    const SurrogateEffects forces = effectForces(input, model);
    Eigen::MatrixXd left = forces.friction_N + forces.load_N;
    for (int i = 0; i < o.axes(); ++i)
      left.col(i) += o.regressor[static_cast<std::size_t>(i)] * model.parameters;
    identification::keepWithinTrainedRange(s.base->trained_force_N, o.motion, left);
    recording::ZeroPhaseLowPass(s.data->stack.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(left);
    left -= o.force_filtered_N;
    for (int n = 0; n < o.samples(); ++n) {
      if (o.motion.uncertain[static_cast<std::size_t>(n)] && o.isJudged(n))
        sum +=
            left.row(n).cwiseQuotient(s.rms_N.transpose()).squaredNorm() * s.data->stack.rate_hz * o.signals.period_s;
    }
  }
  return sum;
}

bool testedElsewhere(const FoundEffect& e) {
  return e.hypothesis.place.candidate->transfers() && !e.hypothesis.place.candidate->local() && e.band_hz == 0.0;
}

/// Squares that each effect (columns) saves on held-back stretches (rows); `total`: what is left with all of them.
Eigen::MatrixXd savedElsewhere(Search& s, const std::vector<Hypothesis>& all, Attention attention, double& total) {
  const Stack own = s.data->stack;
  Eigen::MatrixXd saved = Eigen::MatrixXd::Zero(2 * kStretches, static_cast<Eigen::Index>(all.size()));
  total = 0.0;
  setAttention(*s.data, attention);
  const std::vector<Eigen::MatrixXd> rows = effectRows(*s.data, all);
  for (const int direction : {0, 1}) {
    labelByPosition(s.data->recordings, direction, s.data->stack);
    const JointProblem problem(*s.data, *s.base, s.rms_N, all, rows);
    const Eigen::VectorXd with = problem.heldBack();
    total += with.sum();
    inParallel(all.size(), [&](std::size_t k) {
      if (testedElsewhere(s.effects[k]))
        saved.block(direction * kStretches, static_cast<Eigen::Index>(k), kStretches, 1) =
            problem.heldBackWithout(k) - with;
    });
  }
  s.data->stack = own;
  setAttention(*s.data, s.attention);
  return saved;
}

}  // namespace

void testElsewhere(Search& s, std::vector<std::string>& notes) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  Eigen::VectorXd total(2);
  const Eigen::MatrixXd moving = savedElsewhere(s, all, Attention::Moving, total[0]);
  const Eigen::MatrixXd every = savedElsewhere(s, all, Attention::All, total[1]);
  const double masked = maskedSquares(s, all);
  for (std::size_t k = 0; k < all.size(); ++k) {
    FoundEffect& e = s.effects[k];
    if (!testedElsewhere(e)) continue;
    const Eigen::Index column = static_cast<Eigen::Index>(k);
    const Helps helps = {heldBackGain(moving.col(column)), heldBackGain(every.col(column))};
    const bool surely = helps.surely(e.hypothesis.place.candidate->isForceField());
    const double beside = masked > 0.0 ? maskedSquares(s, without(all, k)) - masked : 0.0;
    const double sum = 2.0 * kStretches * helps.all.mean;
    e.elsewhere_gain = sum / std::max(1e-300, total[1]);
    e.elsewhere_gaining = std::min(helps.moving.gaining, helps.all.gaining);
    const double seen = std::max(0.5 * sum, kStretches * helps.moving.mean);
    const double moving_gain = 2.0 * kStretches * helps.moving.mean / std::max(1e-300, total[0]);
    // Of a chain's many joints an effect on one saves little of all squares.
    const bool worth =
        s.data->inputs.front().robot->chain || std::max(e.elsewhere_gain, moving_gain) >= kWorthElsewhere;
    const bool helpful = surely && seen + beside > 0.0 && worth;
    if (helpful && e.hypothesis.place.candidate->knownElsewhere()) continue;
    e.transfers = false;
    if (helpful) {
      notes.push_back(placeText(e.hypothesis.place) +
                      ": where another recording finds it is not known; it is left out of predictions elsewhere.");
      continue;
    }
    const std::string share = shortNumber(100.0 * e.elsewhere_gain, 2) + " +- " +
                              shortNumber(100.0 * 2.0 * kStretches * helps.all.error / std::max(1e-300, total[1]), 2);
    const std::string at = "at held-back positions of the training recordings it ";
    notes.push_back(placeText(e.hypothesis.place) + ": " +
                    (surely && worth  ? "it makes the error larger where the pose is masked"
                     : surely         ? at + "does not help enough (" + share + " % of the squares)"
                     : helps.surely() ? at + "helps at rest alone, where friction may take any value"
                                      : at + "does not surely help (" + share + " % of the squares)") +
                    "; it is left out of predictions elsewhere.");
  }
}

namespace {

/// What the training recordings leave with these effects alone, rms N: with a ripple that is not predicted an axis
/// leaves far less, and would outweigh all others.
Eigen::VectorXd leftWith(Search& s, const std::vector<FoundEffect>& effects) {
  const std::vector<FoundEffect> all = std::exchange(s.effects, effects);
  refit(s);
  const Eigen::VectorXd left_N = s.rms_N;
  s.effects = all;
  refit(s);
  return left_N;
}

/// Predicted elsewhere, and reported without a name or as one "or unnamed".
bool isUnsureElsewhere(const FoundEffect& e) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  return e.transfers && !candidate.local() && (e.maybeUnnamed() || e.isOneOfMany() || candidate.isMap());
}

/// Where something is predicted elsewhere that may be another effect or has no name, the prior holds links at least as
/// strongly as in the baseline, and laws near rest are chosen anew: beside a force that is only nearly right the data
/// may seem to bend links, which shows at other poses, on other actuators.
void holdLinks(Search& s, const BaseFit& baseline) {
  if (std::none_of(s.effects.begin(), s.effects.end(), isUnsureElsewhere) || s.base->strength >= baseline.strength)
    return;
  rebase(s, baseline.strength);
  settleLaws(s, baseline);
}

}  // namespace

void settleElsewhere(Search& s, const BaseFit& baseline, std::vector<std::string>& notes) {
  holdLinks(s, baseline);
  holdBackOfPaths(s, baseline, notes);
}

bool helpsElsewhere(Search& s, const BaseFit& baseline) {
  std::vector<FoundEffect> predicted;  // a push stays in: what it did to training must not go into the parameters
  std::copy_if(s.effects.begin(), s.effects.end(), std::back_inserter(predicted),
               [](const FoundEffect& e) { return e.hypothesis.place.candidate->local() || isPredicted(e); });
  // Other laws near rest alone, chosen beside what is not predicted: the baseline's were chosen on the same recordings.
  // So it is beside what happened once and may be another force, of a place where the robot was once, too.
  if (std::none_of(predicted.begin(), predicted.end(),
                   [](const FoundEffect& e) { return !e.hypothesis.place.candidate->local() || !e.maybeUnnamed(); }))
    return false;
  // What is there elsewhere, too, with an unknown phase; of other effects that stay behind nobody knows what they are.
  std::vector<FoundEffect> in_phase;
  std::copy_if(s.effects.begin(), s.effects.end(), std::back_inserter(in_phase), [](const FoundEffect& e) {
    const Candidate& candidate = *e.hypothesis.place.candidate;
    return !candidate.periodic() || isPredicted(e);
  });
  const Eigen::VectorXd noise_N = in_phase.size() < s.effects.size() ? leftWith(s, in_phase) : s.rms_N;
  const std::vector<Hypothesis> hypotheses = hypothesesOf(predicted);
  // Beside others a push is in both: where most of it is held back its size is anything, and that would speak against
  // them.
  std::vector<Hypothesis> local;
  std::copy_if(hypotheses.begin(), hypotheses.end(), std::back_inserter(local),
               [](const Hypothesis& h) { return h.place.candidate->local(); });
  if (local.size() == hypotheses.size()) local.clear();
  const Attention own = s.attention;
  const auto gain = [&](Attention attention) {
    s.attention = attention;
    setAttention(*s.data, attention);
    return heldBackGain(baselineLeaves(s, baseline, local, noise_N, heldBackPositions) -
                        heldBackPositions(s, hypotheses, noise_N));
  };
  const Helps helps = {gain(Attention::Moving), gain(Attention::All)};
  s.attention = own;
  setAttention(*s.data, own);
  return helps.surely();
}

ElsewhereFit fitElsewhere(Search& s, const BaseFit& baseline, bool keep_laws) {
  const std::vector<FoundEffect> all = s.effects;
  const auto transfers = [](const FoundEffect& e) { return e.transfers; };
  const auto stays = [](const FoundEffect& e) { return e.transfers || e.hypothesis.place.candidate->local(); };
  s.effects.erase(std::stable_partition(s.effects.begin(), s.effects.end(), stays), s.effects.end());
  refit(s);
  if (s.effects.size() < all.size() && !keep_laws) {
    const bool unsure = std::any_of(s.effects.begin(), s.effects.end(), isUnsureElsewhere);
    rebase(s, unsure ? baseline.strength : 0.0);
    settleLaws(s, baseline);
  }
  ElsewhereFit out;
  std::copy_if(s.effects.begin(), s.effects.end(), std::back_inserter(out.effects), transfers);
  out.parameters = s.base->parametersOf(s.fit.base);
  out.seen_parameters = s.seen_parameters;
  s.effects = all;
  refit(s);
  return out;
}

}  // namespace knee_robot::tracing
