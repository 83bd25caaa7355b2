#include "knee_robot/tracing/trace.h"

#include <algorithm>
#include <cmath>

#include "given_search.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

constexpr double kTogether = 0.9;      ///< correlation of two positions above which they are not told apart
constexpr double kClearly = 2.0;       ///< standard errors by which the one must explain more than the other
constexpr double kWorseBy = 1.2;       ///< and the factor of the held-back squares
constexpr double kNothingLeft = 0.02;  ///< share of a column's square that the base parameters leave: absorbed

TraceData makeData(const mechanism::Robot& robot, std::vector<identification::Observation> training,
                   const TraceOptions& options, BaseFit& base) {
  TraceData data;
  data.recordings = std::move(training);
  data.stack = makeStack(data.recordings, options.observation);
  Eigen::VectorXd given;
  if (options.start) given = startParameters(*options.start, identification::columnsOf(robot));
  base = fitBase(robot, data.recordings, data.stack, identification::columnsOf(robot), options.rank,
                 options.start ? &given : nullptr);
  BaseFit newtons = base;
  newtons.noise_N.setOnes();
  data.all_base_rows = baseRows(newtons, data.recordings, data.stack);
  data.all_force_rows = forceRows(newtons, data.recordings, data.stack);
  setAttention(data, Attention::Moving);
  const int count = static_cast<int>(data.recordings.size());
  for (int r = 0; r < count; ++r) {
    data.inputs.push_back(effectInput(robot, data.recordings[static_cast<std::size_t>(r)], base.memory, r, count));
    setForces(data.inputs.back(), base.columns, base.parameters, {});
  }
  return data;
}

std::vector<Eigen::MatrixXd> modelForces(const TraceData& data) {
  std::vector<Eigen::MatrixXd> out;
  for (const EffectInput& input : data.inputs)
    out.push_back(input.force_N);
  return out;
}

constexpr double kTooMuch = 1.3;

/// Axes whose clean twin leaves much more than the recording itself are not what the twin says they are (friction that stops them
/// otherwise than stiction does): their twins go along the measured motion instead. True when there are any.
bool openLoops(const Eigen::VectorXd& twin_N, const Eigen::VectorXd& real_N, std::vector<TwinPlan>& plans,
               std::vector<std::string>& notes) {
  bool any = false;
  for (Eigen::Index i = 0; i < twin_N.size(); ++i) {
    if (plans.front().open_loop[static_cast<std::size_t>(i)] || twin_N[i] <= kTooMuch * real_N[i]) continue;
    any = true;
    for (TwinPlan& plan : plans)
      plan.open_loop[static_cast<std::size_t>(i)] = 1;
    notes.push_back("Actuator " + std::to_string(i + 1) + ": a clean twin in closed loop leaves " +
                    shortNumber(twin_N[i], 3) + " N, more than the recording (" + shortNumber(real_N[i], 3) +
                    " N), so its twins follow the measured motion; they miss part of what reversals leave.");
  }
  return any;
}

/// Two names may remain; more than that is no attribution.
void settleNames(std::vector<FoundEffect>& effects) {
  for (FoundEffect& e : effects) {
    if (e.indistinguishable_from.size() <= 2) continue;
    e.verdict = "not separable from more than two other effects";
  }
}

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

/// Does the effect explain the training data clearly better with its own position than with the one that went with it? Both are
/// fitted with everything else; compared block by block.
bool clearlyOwn(const Search& s, std::size_t effect, int own, int other) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  std::vector<Eigen::MatrixXd> rows;
  for (const Hypothesis& h : all)
    rows.push_back(effectRows(*s.data, h));
  const Eigen::VectorXd mine = fitJointly(*s.data, *s.base, s.rms_N, all, rows).held_back;
  const std::vector<identification::Observation> seen = asSeenFrom(*s.data, own, other);
  std::vector<EffectInput> inputs = s.data->inputs;
  for (std::size_t r = 0; r < inputs.size(); ++r)
    inputs[r].observation = &seen[r];
  inputs.swap(s.data->inputs);
  rows[effect] = effectRows(*s.data, all[effect]);
  inputs.swap(s.data->inputs);
  const Eigen::VectorXd theirs = fitJointly(*s.data, *s.base, s.rms_N, all, rows).held_back;
  const Eigen::ArrayXd worse = theirs - mine;
  const double n = static_cast<double>(worse.size()), mean = worse.mean();
  const double error = std::sqrt((worse - mean).square().sum() / (n * (n - 1.0)));
  return mean > kClearly * error && theirs.sum() > kWorseBy * mine.sum();
}

/// An effect that depends on a position which always went with another one in training is seen, but not what it depends on: on
/// another path, where the two part, it would predict anything.
void holdBackAmbiguous(const Search& s, std::vector<FoundEffect>& effects, std::vector<std::string>& notes) {
  const TraceData& data = *s.data;
  for (std::size_t k = 0; k < effects.size(); ++k) {
    FoundEffect& e = effects[k];
    const int own = e.hypothesis.place.candidate->positionOf(e.hypothesis.place.actuator);
    if (own < 0 || data.recordings.front().motion.motion.empty()) continue;
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

void noteAbsorbed(const Search& s, const CandidateList& candidates, TraceResult& result) {
  const Projection projection = project(weighted(s.data->stack, s.data->base_rows, s.rms_N),
                                        weighted(s.data->stack, s.data->force_rows, s.rms_N));
  for (const auto& candidate : candidates) {
    if (candidate->shared()) continue;
    double most = 0.0;  // of any shape on any actuator
    for (int i = 0; i < s.data->stack.axes; ++i) {
      std::vector<Hypothesis> all;
      for (std::vector<double>& shape : candidate->shapes(s.data->inputs.front(), i))
        all.push_back({{candidate.get(), i}, std::move(shape)});
      for (const double survives : makeProbes(*s.data, all, projection, s.rms_N).survives)
        most = std::max(most, survives);
    }
    if (most < kNothingLeft)
      result.absorbed.push_back(candidate->name() +
                                ": the baseline's constant force and friction of the actuator take it up");
  }
  result.absorbed.push_back("reflected_inertia: is a parameter of the baseline (rotor)");
  if (s.data->recordings.front().motion.motion.empty()) return;
  result.absorbed.push_back(result.payload.sentence);
  result.absorbed.push_back("base_tilt: turns gravity, which the fitted first moments and offsets follow");
}

}  // namespace

TraceResult trace(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                  std::vector<identification::Observation> training, const TraceOptions& options) {
  TraceResult result;
  options.progress("fitting the baseline");
  TraceData data = makeData(robot, std::move(training), options, result.base);
  std::vector<TwinPlan> plans;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    plans.push_back(planTwin(robot, recordings[r], data.recordings[r], result.base));
    result.notes.push_back(plans.back().note + ".");
  }
  const TwinModel clean = {result.base.parameters, {}, {}};
  options.progress("simulating " + std::to_string(options.twins) + " clean twins");
  std::vector<TraceData> twins =
      makeTwins(robot, recordings, data, result.base, clean, plans, options.observation, options.twins, options.seed);
  const Eigen::VectorXd left_N = twinResidual(twins, result.base, {});
  const bool open = openLoops(left_N, result.base.noise_N, plans, result.notes);

  Search s;
  s.data = &data;
  s.base = &result.base;
  s.twins = &twins;
  s.options = &options;
  s.rms_N = result.base.noise_N;
  result.candidates = std::make_shared<CandidateList>(namedCandidates(robot));
  result.baseline = result.base;
  /// Half as many along the measured motion, beside those in closed loop: an effect must beat both.
  const auto addOpen = [&](const TwinModel& model) {
    if (!open) return;
    std::vector<TraceData> more = makeTwins(robot, recordings, data, result.base, model, plans, options.observation,
                                            options.twins / 2, options.seed + 1u);
    for (TraceData& twin : more)
      twins.push_back(std::move(twin));
  };
  const auto setFloor = [&] {
    Eigen::VectorXd left = twinResidual(twins, result.base, hypothesesOf(s.effects));
    if (open && s.attention == Attention::Moving) {
      const Eigen::VectorXd open_N = twinResidual(twins, result.base, hypothesesOf(s.effects), options.twins);
      for (Eigen::Index i = 0; i < left.size(); ++i) {
        if (plans.front().open_loop[static_cast<std::size_t>(i)]) left[i] = open_N[i];
      }
    }
    s.floor = noiseFloor(recordings, data, modelForces(data), left);
  };
  addOpen(clean);
  s.rebuild_twins = [&] {
    const TwinModel model = modelOf(s);
    std::vector<TwinPlan> closed = plans;
    for (std::size_t r = 0; r < plans.size(); ++r) {
      refreshPlan(data.recordings[r], result.base, model.parameters, data.inputs[r].share,
                  effectForces(data.inputs[r], model), plans[r]);
      closed[r] = plans[r];
      for (std::size_t i = 0; i < closed[r].open_loop.size(); ++i)
        closed[r].open_loop[i] = !closed[r].controllers[i].recovered;
    }
    twins = makeTwins(robot, recordings, data, result.base, model, closed, options.observation, options.twins,
                      options.seed + 17u * s.effects.size());
    addOpen(model);
    for (TraceData& twin : twins)
      setAttention(twin, s.attention);
    setFloor();
  };
  const auto attend = [&](Attention next) {
    s.attention = next;
    setAttention(data, next);
    for (TraceData& twin : twins)
      setAttention(twin, next);
    refit(s);
    setFloor();
  };
  attend(Attention::All);
  CandidateList given_maps;
  if (options.start) {
    result.given = startFrom(robot, *options.start, *result.candidates, given_maps, s);
    if (!s.effects.empty()) {
      options.progress("simulating twins that have the given model's effects");
      s.rebuild_twins();
    }
  }
  const NoiseFloor all = s.floor;
  result.before_rms_N = s.rms_N;
  result.base.parameters = result.baseline.parameters = result.base.parametersOf(s.fit.base);
  result.payload = testPayload(robot, data.recordings, data.stack, result.base, s.rms_N);
  noteAbsorbed(s, *result.candidates, result);
  result.angles = principalAngles(
      data, *result.candidates,
      project(weighted(data.stack, data.base_rows, s.rms_N), weighted(data.stack, data.force_rows, s.rms_N)), s.rms_N);
  attend(Attention::Moving);
  options.progress("looking at moving samples");
  searchForward(s, *result.candidates, options.most_effects, options.seed);
  result.rejected = s.rejected;
  options.progress("looking at all samples");
  attend(Attention::All);
  searchForward(s, *result.candidates, options.most_effects - static_cast<int>(s.effects.size()), options.seed + 50u);
  result.rejected.insert(result.rejected.end(), s.rejected.begin(), s.rejected.end());

  options.progress("looking for what no named effect explains");
  attend(Attention::Moving);
  CandidateList maps = mapCandidates(data.inputs);
  searchForward(s, maps, options.most_maps, options.seed + 100u);
  result.rejected.insert(result.rejected.end(), s.rejected.begin(), s.rejected.end());
  for (CandidateList* list : {&given_maps, &maps}) {
    for (auto& map : *list)
      result.candidates->push_back(std::move(map));
  }
  attend(Attention::All);
  s.floor = all;
  settleNames(s.effects);

  holdBackAmbiguous(s, s.effects, result.notes);
  result.effects = s.effects;
  result.parameters = result.base.parametersOf(s.fit.base);
  result.seen_parameters = s.seen_parameters;
  result.floor_N = s.floor.rms_N;
  result.floor_source = s.floor.source;
  result.after_rms_N = s.rms_N;
  const auto transfers = [](const FoundEffect& e) { return e.transfers; };
  if (!std::all_of(s.effects.begin(), s.effects.end(), transfers)) {
    Search without = s;  // friction that was fitted beside an effect is wrong where that is left out
    without.effects.erase(std::stable_partition(without.effects.begin(), without.effects.end(), transfers),
                          without.effects.end());
    refit(without);
    TraceResult elsewhere = result;
    elsewhere.effects = without.effects;
    elsewhere.parameters = result.base.parametersOf(without.fit.base);
    elsewhere.seen_parameters = without.seen_parameters;
    result.elsewhere = std::make_shared<const TraceResult>(std::move(elsewhere));
  }
  return result;
}

Eigen::MatrixXd predictTraced(const mechanism::Robot& robot, const TraceResult& result, identification::Observation& o,
                              int recording, int recordings) {
  if (recording < 0 && result.elsewhere) return predictTraced(robot, *result.elsewhere, o, recording, recordings);
  setFriction(o, result.base.columns, result.base.memory);
  EffectInput input = effectInput(robot, o, result.base.memory, recording, recordings);
  Eigen::MatrixXd effects_N = Eigen::MatrixXd::Zero(o.samples(), o.axes());
  for (int pass = 0; pass < 2; ++pass) {  // some effects look at the whole force, which contains them
    setForces(input, result.base.columns, result.seen_parameters, effects_N);
    effects_N.setZero();
    for (const FoundEffect& e : result.effects) {
      const Eigen::VectorXd coefficients =
          recording < 0 ? e.hypothesis.place.candidate->elsewhere(e.coefficients) : e.coefficients;
      if (coefficients.size() == 0 || (recording < 0 && !e.transfers)) continue;
      for (int i = 0; i < o.axes(); ++i)
        effects_N.col(i) += effectColumns(input, e.hypothesis, i) * coefficients;
    }
  }
  setForces(input, result.base.columns, result.parameters, effects_N);
  return input.force_N;
}

Eigen::MatrixXd predictBaseline(const TraceResult& result, identification::Observation& o) {
  setFriction(o, result.baseline.columns, result.baseline.memory);
  Eigen::MatrixXd out(o.samples(), o.axes());
  for (int i = 0; i < o.axes(); ++i)
    out.col(i) = o.regressor[static_cast<std::size_t>(i)] * result.baseline.parameters;
  return out;
}

}  // namespace knee_robot::tracing
