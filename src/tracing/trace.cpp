#include "knee_robot/tracing/trace.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "absorbed.h"
#include "abstain.h"
#include "ambiguous.h"
#include "among_found.h"
#include "decide.h"
#include "doubt.h"
#include "elsewhere.h"
#include "fit_feedforward.h"
#include "given_search.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/plausible_fit.h"
#include "knee_robot/recording/signals.h"
#include "near_rest.h"
#include "one_path.h"
#include "predict_elsewhere.h"
#include "refine.h"
#include "refit.h"
#include "rivals.h"
#include "search.h"
#include "settle_heat.h"
#include "settle_laws.h"
#include "settle_lead.h"
#include "surfaces.h"
#include "taken_for.h"

namespace knee_robot::tracing {
namespace {

constexpr double kFaster = 3.0;  ///< cut-off of the second band over that of the first,
constexpr double kFastestShareOfRate = 0.1;
constexpr double kLeastFaster = 1.5;       ///< below which a second band would be the first one again
constexpr double kMoreThanItsNoise = 1.5;  ///< floors
constexpr int kFastSurrogates = 5;
constexpr int kMostFastRows = 16'000;  ///< of its baseline: five a period of its cut-off say as much as ten

/// One run of tracing: its stages in order, and what they share.
class Tracing {
 public:
  Tracing(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
          const TraceOptions& options)
      : robot_(robot), recordings_(recordings), options_(options) {}

  TraceResult run(std::vector<identification::Observation> training) {
    fitBaseline(std::move(training), nullptr);
    planSurrogates(true);
    gatherCandidates();
    startFromGivenModel();
    describeBaseline();
    searchEffects();
    searchSurfaces();
    searchFastBand();
    settle();
    predictElsewhere(robot_, s_, result_);
    fitFeedforward(s_, result_, options_.start != nullptr);
    return std::move(result_);
  }

  /// Whether the second band, in which nothing but the first one's baseline is fitted, leaves no more than noise.
  bool isQuiet(std::vector<identification::Observation> training, const Tracing& slow) {
    fitBaseline(std::move(training), &slow.result_.base);
    planSurrogates(true);
    if (exceedsFloor(s_)) return false;
    attend(Attention::Moving);
    return !exceedsFloor(s_);
  }

  /// The second band: what shows in fast motion only, beside what `slow` has found. Returns what leads, which was looked
  /// at anew, and what was added.
  std::vector<FoundEffect> runFast(std::vector<identification::Observation> training, const Tracing& slow) {
    const std::vector<FoundEffect>& found = slow.s_.effects;
    fitBaseline(std::move(training), found.empty() ? nullptr : &slow.result_.base);
    planSurrogates(found.empty());
    library_.add(*slow.result_.candidates, data_, true);
    updateNearRest(s_);
    s_.effects = found;
    if (!found.empty()) {
      refit(s_);
      rebase(s_);
      rebuildSurrogates();
    }
    searchEffects();
    const auto kept = [&](const FoundEffect& e) {
      return e.hypothesis.place.candidate->leads() || (e.hypothesis.place.candidate->actsFast() && !isAmong(found, e));
    };
    dropLeadsOfRest(s_);
    if (std::none_of(found.begin(), found.end(), leads)) settleLeads(s_);
    s_.effects.erase(std::stable_partition(s_.effects.begin(), s_.effects.end(), kept), s_.effects.end());
    return s_.effects;
  }

 private:
  void fitBaseline(std::vector<identification::Observation> training, const BaseFit* known);
  void planSurrogates(bool simulate_baseline);
  void gatherCandidates();
  void startFromGivenModel();
  void describeBaseline();
  void searchEffects();
  void offerMaps();
  int kindsLeft() const;  ///< that may still be added
  void searchSurfaces();
  void searchFastBand();
  void settle();

  void attend(Attention next);
  void simulate(const SurrogateModel& model);
  void believeSurrogates(const SurrogateModel& model);
  void rebuildSurrogates();
  void setFloor();

  const mechanism::Robot& robot_;
  const std::vector<recording::Recording>& recordings_;
  const TraceOptions& options_;
  TraceData data_;
  std::vector<SurrogatePlan> plans_;
  Library library_;
  CandidateList maps_;  ///< of the given model, and those that are tried
  bool maps_offered_ = false;
  std::size_t given_effects_ = 0;
  Search s_;
  TraceResult result_;
};

/// `known`: to begin with where effects are found already, and it will be fitted anew beside them.
void Tracing::fitBaseline(std::vector<identification::Observation> training, const BaseFit* known) {
  if (known == nullptr) options_.progress("fitting the baseline");
  data_.recordings = std::move(training);
  for (const identification::Observation& o : data_.recordings)
    result_.home_ids.push_back(o.home_id);
  data_.stack = makeStack(data_.recordings, options_.observation);
  BaseFit& base = result_.base;
  if (known == nullptr) {
    BaseOptions how;
    how.rank = options_.rank;
    if (options_.start) how.given = startParameters(*options_.start, identification::columnsOf(robot_));
    how.laws_of = options_.laws_of;
    base = fitBase(robot_, data_.recordings, data_.stack, identification::columnsOf(robot_), std::move(how));
    result_.doubts =
        identification::doubtsAboutFit(robot_, base.columns, base.parameters, data_.recordings, options_.observation);
  } else {
    base = laidUnder(*known, data_.recordings);
  }
  const BaseFit newtons = inNewtons(base);
  data_.all_base_rows = baseRows(newtons, data_.recordings, data_.stack);
  data_.all_force_rows = forceRows(newtons, data_.recordings, data_.stack);
  setAttention(data_, Attention::All);
  const int count = static_cast<int>(data_.recordings.size());
  for (int r = 0; r < count; ++r) {
    data_.inputs.push_back(
        effectInput(robot_, data_.recordings[static_cast<std::size_t>(r)], base.friction_laws, r, count));
    setModel(data_.inputs.back(), base.columns, base.parameters);
  }
  result_.baseline = base;
  s_.data = &data_;
  s_.base = &base;
  s_.library = &library_;
  s_.options = &options_;
  s_.rms_N = base.noise_N;
  s_.rebuild_surrogates = [this] { rebuildSurrogates(); };
}

void Tracing::planSurrogates(bool simulate_baseline) {
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    plans_.push_back(planSurrogate(robot_, recordings_[r], data_.recordings[r], result_.base));
    result_.notes.push_back(plans_.back().note + ".");
  }
  if (!simulate_baseline) return;  // they will be simulated with effects
  options_.progress("simulating " + std::to_string(options_.surrogates) + " surrogates of the recordings");
  const SurrogateModel clean = {result_.base.parameters, {}, {}};
  s_.surrogates = makeSurrogates(robot_, recordings_, data_, result_.base, clean, plans_, options_.observation,
                                 options_.surrogates, options_.seed);
  believeSurrogates(clean);
  attend(Attention::All);
}

/// Simulates them once more where those of some axes do not behave as the machine does. With effects that were found a
/// closed loop may sway that did not before: they are compared with what the baseline leaves, all the same.
void Tracing::believeSurrogates(const SurrogateModel& model) {
  const std::vector<std::string> opened =
      openLoops(surrogateResidual(s_.surrogates, data_, result_.base), result_.base.noise_N, plans_);
  result_.notes.insert(result_.notes.end(), opened.begin(), opened.end());
  if (!opened.empty()) simulate(model);
}

void Tracing::simulate(const SurrogateModel& model) {
  s_.surrogates = makeSurrogates(robot_, recordings_, data_, result_.base, model, plans_, options_.observation,
                                 options_.surrogates, options_.seed + 17u * model.effects.size());
}

void Tracing::rebuildSurrogates() {
  const SurrogateModel model = modelOf(s_);
  for (std::size_t r = 0; r < plans_.size(); ++r)
    refreshPlan(data_.recordings[r], result_.base, model.parameters, data_.inputs[r].share,
                effectForces(data_.inputs[r], model), plans_[r]);
  simulate(model);
  believeSurrogates(model);
  setFloor();
}

void Tracing::setFloor() {
  std::vector<Eigen::MatrixXd> forces;
  for (const EffectInput& input : data_.inputs)
    forces.push_back(input.force_N);
  s_.floor = noiseFloor(recordings_, data_, forces, surrogateResidual(s_.surrogates, data_, result_.base));
}

void Tracing::attend(Attention next) {
  s_.attention = next;
  setAttention(data_, next);
  refit(s_);
  setFloor();
}

void Tracing::gatherCandidates() {
  result_.candidates = std::make_shared<CandidateList>(namedCandidates(robot_));
  library_.add(*result_.candidates, data_);
  updateNearRest(s_);
  if (options_.most_effects > 0 && options_.maps) maps_ = mapCandidates(data_.inputs);
}

/// When they are needed: their columns are half of what a recording costs that has nothing to explain.
void Tracing::offerMaps() {
  if (!std::exchange(maps_offered_, true)) library_.add(maps_, data_);
}

void Tracing::startFromGivenModel() {
  if (options_.start) {
    result_.given = startFrom(robot_, *options_.start, *result_.candidates, maps_, s_);
    if (!s_.effects.empty()) {
      options_.progress("simulating surrogates that have the given model's effects");
      s_.rebuild_surrogates();
    }
  }
  given_effects_ = s_.effects.size();
  result_.before_rms_N = s_.rms_N;
  // Without a given model before is what identify fits: its loss and weights, not those of the search.
  if (options_.start) result_.base.parameters = result_.baseline.parameters = result_.base.parametersOf(s_.fit.base);
  result_.floor_N = s_.floor.rms_N;
  result_.floor_source = s_.floor.source;
}

void Tracing::describeBaseline() {
  result_.payload = testPayload(robot_, data_.recordings, data_.stack, result_.base, s_.rms_N);
  result_.payload.is_effect = robot_.chain && options_.start && result_.payload.stated;
  // Without the prior: what the columns of the baseline can do, not what it is ready to believe.
  const Projection projection =
      project(weighted(data_.stack, data_.base_rows, s_.rms_N), weighted(data_.stack, data_.force_rows, s_.rms_N));
  noteWhatIsAbsorbed(s_, projection, result_);
  result_.angles = principalAngles(data_, library_.places(), projection, s_.rms_N);
}

int Tracing::kindsLeft() const {
  std::set<const Candidate*> kinds;
  for (std::size_t k = given_effects_; k < s_.effects.size(); ++k)
    kinds.insert(s_.effects[k].hypothesis.place.candidate);
  return options_.most_effects - static_cast<int>(kinds.size());
}

/// First with samples near rest counting little, then with all alike.
void Tracing::searchEffects() {
  if (options_.most_effects == 0) return;
  for (const Attention attention : {Attention::Moving, Attention::All}) {
    attend(attention);
    s_.maps = attention == Attention::Moving;  // near rest a map over velocity mends the law of friction
    if (s_.maps && exceedsFloor(s_)) offerMaps();
    options_.progress(attention == Attention::Moving ? "looking at moving samples" : "looking at all samples");
    searchForward(s_, kindsLeft(), options_.seed + (attention == Attention::All ? 50u : 0u));
    result_.rejected.insert(result_.rejected.end(), s_.rejected.begin(), s_.rejected.end());
  }
}

/// Of two recordings or more: where all else leaves more than noise while axes move; and names that had rivals, beside
/// all that was found.
void Tracing::searchSurfaces() {
  if (options_.most_effects == 0 || !options_.maps || recordings_.size() < 2) return;
  attend(Attention::Moving);
  if ((s_.rms_N.array() > kMoreThanItsNoise * s_.floor.rms_N.array()).any()) {
    options_.progress("looking at surfaces over two signals");
    offerMaps();
    CandidateList surfaces;
    addSurfaces(data_.inputs, surfaces);
    library_.add(surfaces, data_);
    std::move(surfaces.begin(), surfaces.end(), std::back_inserter(maps_));
    s_.maps = true;
    searchForward(s_, kindsLeft(), options_.seed + 90u);
    result_.rejected.insert(result_.rejected.end(), s_.rejected.begin(), s_.rejected.end());
  }
  reconsiderRivals(s_);
  s_.maps = false;
  attend(Attention::All);
}

/// Delays, lags and joints that give hardly change slow forces: looked for again in a band three times as high, beside
/// what was found.
void Tracing::searchFastBand() {
  double rate_hz = 1e9;
  for (const recording::Recording& r : recordings_)
    rate_hz = std::min(rate_hz, 1.0 / recording::medianPeriod(r.time_s));
  const double cutoff_hz = options_.observation.cutoff_hz;
  const double fast_hz = std::min(kFaster * cutoff_hz, kFastestShareOfRate * rate_hz);
  // Where they show already: a lag's derivative carries the faster band's noise of positions, a delay does not.
  settleLeads(s_);
  if (!options_.fast_band || options_.most_effects == 0 || fast_hz < kLeastFaster * cutoff_hz) return;
  options_.progress("looking at the band up to " + shortNumber(fast_hz, 3) + " Hz");
  TraceOptions options = options_;
  options.observation.setCutoff(fast_hz);
  options.observation.most_rows = kMostFastRows;
  options.start = nullptr;
  options.laws_of = nullptr;
  options.surrogates = kFastSurrogates;
  std::vector<identification::Observation> training =
      identification::observeAll(robot_, s_.base->columns, recordings_, options.observation);
  if (s_.effects.empty() && Tracing(robot_, recordings_, options).isQuiet(training, *this)) return;
  Tracing fast(robot_, recordings_, options);
  const std::vector<FoundEffect> seen = fast.runFast(std::move(training), *this);
  const auto known = std::find_if(s_.effects.begin(), s_.effects.end(), leads);
  const Candidate* const settled = known == s_.effects.end() ? nullptr : known->hypothesis.place.candidate;
  for (FoundEffect e : seen) {
    if (isKnownLead(s_.effects, e)) continue;
    if (leads(e) && settled != nullptr) e.hypothesis.place.candidate = settled;
    e.band_hz = fast_hz;
    s_.effects.push_back(e);
    result_.notes.push_back(placeText(e.hypothesis.place) + " was found in the band up to " + shortNumber(fast_hz, 3) +
                            " Hz.");
  }
  if (!seen.empty()) refit(s_);
}

void Tracing::settle() {
  dropLeadsOfRest(s_);
  dropWhatDoesNotRepeat(s_);
  if (s_.effects.size() > 1) eliminateBackward(s_);
  refineShapes(s_);
  for (const auto& candidate : *result_.candidates) {
    const std::string heat = settleHeat(s_, candidate.get());
    if (!heat.empty()) result_.notes.push_back(heat);
  }
  preferSimpler(s_);
  settleLaws(s_, result_.baseline);
  dropImplausible(s_);
  dropUnsized(s_);
  explainAnew(s_);
  for (auto& map : maps_)
    result_.candidates->push_back(std::move(map));
  if (robot_.chain) abstainElsewhere(s_, result_.notes);
  holdBackAmbiguous(s_, result_.notes);
  if (!robot_.chain) testElsewhere(s_, result_.notes);
  if (!robot_.chain) doubtNames(s_, result_.notes);
  holdBackOnePath(s_, result_.notes);
  if (!options_.start && !robot_.chain) settleElsewhere(s_, result_.baseline, result_.notes);
  result_.rejected.insert(result_.rejected.end(), s_.taken_out.begin(), s_.taken_out.end());
  keepFit(s_, result_);
}

}  // namespace

TraceResult trace(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                  std::vector<identification::Observation> training, const TraceOptions& options) {
  return Tracing(robot, recordings, options).run(std::move(training));
}

}  // namespace knee_robot::tracing
