#include "refit.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/parallel.h"

namespace knee_robot::tracing {
namespace {

constexpr int kPasses = 4;                  ///< of fitting and rebuilding what depends on the fit
constexpr double kSettled = 2e-3;           ///< of what is left, from pass to pass
constexpr int kPassesOfForwardModels = 16;  ///< where the baseline has to let go of what they change
constexpr int kPassesOfWeights = 2;         ///< where no effect's columns depend on it
constexpr double kLeastCoulomb_N = 1e-3;
constexpr double kLinear = 1e-9;
constexpr double kAlike = 0.03;  ///< of what the model leaves: change of effects beside which a baseline stays as it is

}  // namespace

Eigen::VectorXd rmsOf(const Stack& stack, const Eigen::VectorXd& residual_N) {
  Eigen::VectorXd rms(stack.axes);
  for (int i = 0; i < stack.axes; ++i)
    rms[i] = residual_N.segment(i * stack.size(), stack.size()).norm() / std::sqrt(static_cast<double>(stack.size()));
  return rms;
}

std::vector<Hypothesis> hypothesesOf(const std::vector<FoundEffect>& effects) {
  std::vector<Hypothesis> out;
  for (const FoundEffect& e : effects)
    out.push_back(e.hypothesis);
  return out;
}

JointProblem problemOf(const Search& s, const std::vector<Hypothesis>& effects) {
  return {*s.data, *s.base, s.rms_N, effects, effectRows(*s.data, effects)};
}

JointFit fitOf(const Search& s, const std::vector<Hypothesis>& effects, LeftOut left_out) {
  return problemOf(s, effects).fit(left_out);
}

Eigen::VectorXd heldBackInAll(const Search& s, const Eigen::VectorXd& noise_N) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  setAttention(*s.data, Attention::All);
  Eigen::VectorXd out = JointProblem(*s.data, *s.base, noise_N, all, effectRows(*s.data, all)).heldBack();
  setAttention(*s.data, s.attention);
  return out;
}

Eigen::VectorXd explainedBy(const Search& s, std::size_t k) {
  std::vector<Hypothesis> without = hypothesesOf(s.effects);
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
  const Eigen::VectorXd left = rmsOf(s.data->stack, fitOf(s, without, LeftOut::None).residual_N);
  return (left.cwiseAbs2() - s.rms_N.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
}

void explainAnew(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    FoundEffect& e = s.effects[k];
    if (!std::isnan(e.p)) e.explained_rms_N = e.explained_rms_N.cwiseMax(explainedBy(s, k));
  }
}

SurrogateModel modelOf(const Search& s) {
  SurrogateModel m;
  m.parameters = s.base->parametersOf(s.fit.base);
  m.effects = hypothesesOf(s.effects);
  m.coefficients = s.fit.coefficients;
  return m;
}

void refit(Search& s) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  if (s.seen_parameters.size() == 0) s.seen_parameters = s.base->parameters;
  std::vector<Eigen::MatrixXd> rows = effectRows(*s.data, all);
  const auto fit = [&](LeftOut left_out) {
    s.fit = JointProblem(*s.data, *s.base, s.rms_N, all, rows).fit(left_out);
    s.rms_N = rmsOf(s.data->stack, s.fit.residual_N).cwiseMax(1e-9);
  };
  const bool rests =
      std::any_of(all.begin(), all.end(), [](const Hypothesis& h) { return h.place.candidate->restsOnModel(); });
  const bool forward = std::any_of(all.begin(), all.end(), isWhole);
  const int passes = all.empty() ? 1 : forward ? kPassesOfForwardModels : rests ? kPasses : kPassesOfWeights;
  for (int pass = 0; pass < passes; ++pass) {
    const Eigen::VectorXd left_before_N = s.rms_N;
    fit(LeftOut::None);
    if (pass >= kPasses && (s.rms_N - left_before_N).norm() < kSettled * s.rms_N.norm()) break;
    const Eigen::VectorXd parameters = s.base->parametersOf(s.fit.base);
    if (!rests && pass + 1 < passes) continue;
    // Where columns rest on them, all the way would swing.
    s.seen_parameters = rests ? Eigen::VectorXd(0.5 * (s.seen_parameters + parameters)) : parameters;
    const SurrogateModel model = modelOf(s);
    for (EffectInput& input : s.data->inputs) {
      lookAhead(input, model);
      (void)settleForces(input, s.base->columns, s.seen_parameters, model);
    }
    inParallel(rows.size(), [&](std::size_t k) {
      if (all[k].place.candidate->restsOnModel()) rows[k] = effectRows(*s.data, all[k]);
    });
  }
  fit(LeftOut::EveryBlock);
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    s.effects[k].coefficients = s.fit.coefficients[k];
    s.effects[k].std = s.fit.std[k];
  }
}

/// Effects as the choice of friction's law wants them: what multiplies the law, as factors of Coulomb friction, and the
/// forces of all others.
struct SplitEffects {
  Eigen::MatrixXd level, force_N;
  std::vector<Eigen::MatrixXd> each_N;  ///< of each effect: what force_N is the sum of
};

/// Force of an effect along a recording, samples x axes.
Eigen::MatrixXd forceOf(const EffectInput& input, const Hypothesis& h, const Eigen::VectorXd& coefficients) {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(input.samples(), input.axes());
  Eigen::Index actuator = h.place.actsOnAll() ? 0 : h.place.actuator;
  for (const Eigen::MatrixXd& columns : actingColumns(input, h))
    force.col(actuator++) = columns * coefficients;
  return force;
}

SplitEffects splitEffects(const EffectInput& input, const SurrogateModel& model) {
  SplitEffects out = {
      Eigen::MatrixXd::Ones(input.samples(), input.axes()), Eigen::MatrixXd::Zero(input.samples(), input.axes()), {}};
  EffectInput forward = input, still = input, back = input;
  forward.share.setOnes();
  still.share.setZero();
  back.share.setConstant(-1.0);
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    const auto force = [&](const EffectInput& in) { return forceOf(in, model.effects[k], model.coefficients[k]); };
    const Eigen::MatrixXd always = force(still), with = force(forward) - always, against = force(back) - always,
                          whole = force(input);
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(input.samples(), input.axes());
    for (int i = 0; i < input.axes(); ++i) {
      const double size = with.col(i).norm();
      if (size == 0.0 || (with + against).col(i).norm() > kLinear * size) {  // no factor of the law
        own.col(i) = whole.col(i);
        continue;
      }
      own.col(i) = always.col(i);
      out.level.col(i) += with.col(i) / std::max(kLeastCoulomb_N, input.coulomb_N[i]);
    }
    out.force_N += own;
    out.each_N.push_back(std::move(own));
  }
  out.level = out.level.cwiseMax(0.0);
  return out;
}

bool adoptBase(Search& s, BaseFit base) {
  TraceData& data = *s.data;
  const mechanism::Robot& robot = *data.inputs.front().robot;
  *s.base = std::move(base);
  for (identification::Observation& o : data.recordings)
    identification::setFriction(o, s.base->columns, s.base->friction_laws);
  const BaseFit newtons = inNewtons(*s.base);
  data.all_base_rows = baseRows(newtons, data.recordings, data.stack);
  setAttention(data, s.attention);
  bool changed = false;
  const SurrogateModel model = {s.base->parameters, hypothesesOf(s.effects), s.fit.coefficients};
  for (std::size_t r = 0; r < data.inputs.size(); ++r) {
    const SurrogateEffects effects = effectForces(data.inputs[r], model);
    const Eigen::MatrixXd share = data.inputs[r].share;
    data.inputs[r] = effectInput(robot, data.recordings[r], s.base->friction_laws, data.inputs[r].recording,
                                 data.inputs[r].recordings);
    lookAhead(data.inputs[r], model);
    setModel(data.inputs[r], s.base->columns, s.base->parameters);
    setEffects(data.inputs[r], effects.friction_N + effects.load_N, effects.drive_N);
    changed = changed || data.inputs[r].share != share;
  }
  s.seen_parameters = s.base->parameters;
  refit(s);
  return changed;
}

EffectsBeside besideOf(const Search& s) {
  const SurrogateModel now = {s.base->parameters, hypothesesOf(s.effects), s.fit.coefficients};
  EffectsBeside beside;
  for (const EffectInput& input : s.data->inputs) {
    SplitEffects split = splitEffects(input, now);
    beside.force_N.push_back(std::move(split.force_N));
    beside.level.push_back(std::move(split.level));
    beside.each_N.push_back(std::move(split.each_N));
  }
  // A law keeps its peak, but beside friction it gets no new one, which would make up for what is wrong with that. Beside
  // an effect that makes friction larger near rest it would be the same thing in a coarser form.
  beside.without_peak.assign(s.base->friction_laws.size(), 0);
  for (const Hypothesis& h : now.effects) {
    for (std::size_t i = 0; i < beside.without_peak.size(); ++i) {
      if (h.place.actuator >= 0 && h.place.actuator != static_cast<int>(i)) continue;
      const bool has_none = dynamics::peakOf(s.base->friction_laws[i]) == 0.0;
      const bool rubs = h.place.candidate->isFriction() || h.place.candidate->isMap();
      if (h.place.candidate->actsNearRest() || (rubs && has_none)) beside.without_peak[i] = 1;
    }
  }
  return beside;
}

/// Whether the baseline stands beside these effects already, but for far less than what the model leaves.
bool isBeside(const Search& s, const EffectsBeside& effects) {
  const EffectsBeside& fitted = s.base->beside;
  if (fitted.level.size() != effects.level.size() || fitted.without_peak != effects.without_peak) return false;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(s.rms_N.size());
  double samples = 0.0;
  for (std::size_t r = 0; r < effects.force_N.size(); ++r) {
    const Eigen::MatrixXd change = effects.force_N[r] - fitted.force_N[r] +
                                   (effects.level[r] - fitted.level[r]) * s.data->inputs[r].coulomb_N.asDiagonal();
    squares += change.colwise().squaredNorm();
    samples += static_cast<double>(change.rows());
  }
  return (squares.array() <= samples * (kAlike * s.rms_N.array()).square()).all();
}

bool rebase(Search& s, double least_strength) {
  TraceData& data = *s.data;
  EffectsBeside beside = besideOf(s);
  if (s.base->strength >= least_strength && isBeside(s, beside)) return false;
  const mechanism::Robot& robot = *data.inputs.front().robot;
  BaseOptions how;
  how.rank = s.options->rank;
  how.given = s.base->start;
  how.beside = std::move(beside);
  how.least_strength = least_strength;
  return adoptBase(s, fitBase(robot, data.recordings, data.stack, s.base->columns, std::move(how)));
}

}  // namespace knee_robot::tracing
