#include "search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

constexpr std::size_t kCompared = 10;  ///< places that are refined and cross-validated in every step
constexpr int kRounds = 5;
constexpr double kSlightPull = 1e-6;
constexpr int kLocalPieces = 6;      ///< of a local effect that are held back in turn
constexpr double kMostPieces = 0.8;  ///< share of those that must gain
constexpr double kMostBlocks = 0.5;  ///< share of held-back blocks that must gain
constexpr double kAboveFloor = 1.15;
constexpr double kLowered = 0.9;  ///< the rms of some actuator must fall below this share
constexpr double kLargestP = 0.005;
constexpr double kMapErrors =
    2.5;  ///< standard errors by which a map must help: it bends to much, and extrapolates badly
constexpr double kNearlyAsGood =
    0.9;  ///< share of the best one's held-back gain at which a runner-up is looked at closely

/// A hypothesis that is being compared.
struct Trial {
  Hypothesis hypothesis;
  double share = 0.0;  ///< of squared noise, explained by projection
  JointFit fit;
  Eigen::VectorXd joint_gain;    ///< per held-back block, weighted squares: everything fitted without the block
  Eigen::VectorXd partial_gain;  ///< the same with only the effect fitted without the block
  bool by_joint =
      true;  ///< which of them speaks more clearly: where the baseline extrapolates badly the first says nothing
  Eigen::VectorXd gain;  ///< that one
  double mean_gain = 0.0, gain_error = 0.0;
};

std::string placeText(const Place& p) {
  const std::string what = p.candidate->name() == "unnamed"
                               ? "unnamed (" + p.candidate->dependsOn(std::max(0, p.actuator)) + ")"
                               : p.candidate->name();
  return what + (p.actuator < 0 ? " (all actuators)" : " on actuator " + std::to_string(p.actuator + 1));
}

void setMean(const Eigen::VectorXd& values, double& mean, double& error) {
  const double n = static_cast<double>(values.size());
  mean = values.mean();
  error = std::sqrt((values.array() - mean).square().sum() / (n * (n - 1.0)));
}

/// Which picks are held back together: the stack's blocks; of a local effect, pieces of the part in which it acts (-1: outside).
std::vector<int> heldTogether(const Stack& stack, const Eigen::MatrixXd& columns, bool local, int& count) {
  std::vector<int> block(static_cast<std::size_t>(stack.size()), -1);
  count = local ? kLocalPieces : stack.blocks;
  std::vector<std::size_t> inside;
  for (std::size_t n = 0; n < block.size(); ++n) {
    block[n] = local ? -1 : stack.picks[n].block;
    bool acts = false;
    for (int i = 0; i < stack.axes && !acts; ++i)
      acts = columns.row(i * stack.size() + static_cast<Eigen::Index>(n)).squaredNorm() > 0.0;
    if (acts) inside.push_back(n);
  }
  for (std::size_t k = 0; local && k < inside.size(); ++k)
    block[inside[k]] = static_cast<int>(k * kLocalPieces / inside.size());
  return block;
}

/// Gains of the held-back blocks when the effect's coefficients alone are fitted without them; the baseline is fitted to everything
/// with and without the effect.
Eigen::VectorXd partialGain(const Search& s, const Projection& projection, const Hypothesis& h) {
  const Stack& stack = s.data->stack;
  Eigen::MatrixXd c = weighted(stack, effectRows(*s.data, h), s.rms_N);
  int blocks = 0;
  const std::vector<int> together = heldTogether(stack, c, h.place.candidate->local(), blocks);
  c -= projection.q * (projection.q.transpose() * c).eval();
  const Eigen::Index k = c.cols();
  std::vector<Eigen::MatrixXd> gram(static_cast<std::size_t>(blocks) + 1, Eigen::MatrixXd::Zero(k, k));
  Eigen::MatrixXd image = Eigen::MatrixXd::Zero(k, blocks + 1),
                  all = Eigen::MatrixXd::Zero(k, k);  // last: never held back
  for (int i = 0; i < stack.axes; ++i) {
    for (Eigen::Index n = 0; n < stack.size(); ++n) {
      const auto row = c.row(i * stack.size() + n);
      const int own = together[static_cast<std::size_t>(n)], block = own < 0 ? blocks : own;
      gram[static_cast<std::size_t>(block)] += row.transpose() * row;
      image.col(block) += row.transpose() * projection.residual[i * stack.size() + n];
    }
  }
  for (const Eigen::MatrixXd& own : gram)
    all += own;
  const Eigen::MatrixXd pull = kSlightPull * Eigen::MatrixXd(all.diagonal().asDiagonal());
  const Eigen::VectorXd whole = image.rowwise().sum();
  Eigen::VectorXd gain(blocks);
  for (int b = 0; b < blocks; ++b) {
    const Eigen::MatrixXd& own = gram[static_cast<std::size_t>(b)];
    const Eigen::VectorXd theta = (all - own + pull).ldlt().solve(whole - image.col(b));
    gain[b] = 2.0 * theta.dot(image.col(b)) - theta.dot(own * theta);
  }
  return gain;
}

double shareOf(const Search& s, const Projection& projection, const Hypothesis& h) {
  return explained(*s.data, h, projection, s.rms_N) / static_cast<double>(s.data->stack.size());
}

/// Best shape of every place, best place first.
std::vector<Trial> rankPlaces(const Search& s, const Projection& projection, const std::vector<Hypothesis>& tried) {
  std::vector<Trial> best;
  for (const std::vector<Hypothesis>& group : byPlace(tried)) {
    const Eigen::VectorXd squares = explained(makeProbes(*s.data, group, projection, s.rms_N), projection.residual);
    Eigen::Index at = 0;
    const double most = squares.maxCoeff(&at);
    best.emplace_back();
    best.back().hypothesis = group[static_cast<std::size_t>(at)];
    best.back().share = most / static_cast<double>(s.data->stack.size());
  }
  std::sort(best.begin(), best.end(), [](const Trial& a, const Trial& b) { return a.share > b.share; });
  return best;
}

/// Narrows the shape down between its neighbours on the grid.
void refineShape(const Search& s, const Projection& projection, const std::vector<Hypothesis>& tried, Trial& t) {
  if (t.hypothesis.shape.size() != 1) {
    double step = 1.0;
    for (int round = 0; round < kRounds; ++round, step *= 0.6) {
      for (const std::vector<double>& shape : t.hypothesis.place.candidate->near(t.hypothesis.shape, step)) {
        const Hypothesis h = {t.hypothesis.place, shape};
        const double share = shareOf(s, projection, h);
        if (share <= t.share) continue;
        t.share = share;
        t.hypothesis = h;
      }
    }
    return;
  }
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  const double at = t.hypothesis.shape[0];
  for (const Hypothesis& h : tried) {
    if (!(h.place == t.hypothesis.place)) continue;
    if (h.shape[0] < at) low = std::max(low, h.shape[0]);
    if (h.shape[0] > at) high = std::min(high, h.shape[0]);
  }
  double step = std::min(low > 0.0 ? at / low : 1e9, std::isfinite(high) ? high / at : 1e9);
  if (!(step < 1e9)) return;
  for (int round = 0; round < 4; ++round) {
    step = std::sqrt(step);
    const double center = t.hypothesis.shape[0];
    for (const double value : {center / step, center * step}) {
      Hypothesis h = t.hypothesis;
      h.shape[0] = value;
      const double share = shareOf(s, projection, h);
      if (share <= t.share) continue;
      t.share = share;
      t.hypothesis = h;
    }
  }
}

void crossValidate(const Search& s, const Projection& projection, const std::vector<Eigen::MatrixXd>& rows, Trial& t) {
  std::vector<Hypothesis> all = hypothesesOf(s.effects);
  std::vector<Eigen::MatrixXd> all_rows = rows;
  all.push_back(t.hypothesis);
  all_rows.push_back(effectRows(*s.data, t.hypothesis));
  t.fit = fitJointly(*s.data, *s.base, s.rms_N, all, all_rows);
  t.joint_gain = s.fit.held_back - t.fit.held_back;
  t.partial_gain = partialGain(s, projection, t.hypothesis);
  double partial = 0.0, partial_error = 0.0;
  setMean(t.joint_gain, t.mean_gain, t.gain_error);
  setMean(t.partial_gain, partial, partial_error);
  t.by_joint = !t.hypothesis.place.candidate->local() && t.mean_gain * partial_error >= partial * t.gain_error;
  t.gain = t.by_joint ? t.joint_gain : t.partial_gain;
  setMean(t.gain, t.mean_gain, t.gain_error);
}

/// Empty when the trial may be accepted (but for the null); otherwise why not.
std::string objection(const Search& s, const Trial& t) {
  const Eigen::VectorXd rms = rmsOf(s.data->stack, t.fit.residual_N);
  bool worth_it = false;
  for (int i = 0; i < rms.size(); ++i) {
    if (t.hypothesis.place.actuator >= 0 && t.hypothesis.place.actuator != i) continue;
    worth_it = worth_it || (s.rms_N[i] > kAboveFloor * s.floor.rms_N[i] && rms[i] < kLowered * s.rms_N[i]);
  }
  if (!worth_it) return "does not lower the residual by a tenth where it is above the floor";
  if (t.fit.coefficients.back().cwiseAbs().maxCoeff() == 0.0) return "the sign that fits is not physical";
  if (!t.hypothesis.place.candidate->plausible(t.fit.coefficients.back())) return "the size that fits is not physical";
  if (!t.fit.stable.back()) return "its sign changes when a part of the training data is left out";
  const double errors = t.hypothesis.place.candidate->name() == "unnamed" ? kMapErrors : 1.0;
  const double gaining = (t.gain.array() > 0.0).cast<double>().mean();
  if (t.hypothesis.place.candidate->local()) {  // few pieces, some of them with little motion: their number speaks
    if (gaining >= kMostPieces && t.mean_gain > t.gain_error) return {};
    return "does not help on held-back pieces of the time in which it acts (" + shortNumber(100.0 * gaining, 3) +
           " % of them gain)";
  }
  if (t.mean_gain <= (t.by_joint ? errors : errors + 1.0) * t.gain_error || gaining < kMostBlocks)
    return "does not help on held-back parts of the training data (mean " + shortNumber(t.mean_gain, 3) + " +- " +
           shortNumber(t.gain_error, 3) + ", " + shortNumber(100.0 * gaining, 3) + " % of them gain)";
  return {};
}

/// Names that the data cannot tell from the best one: their held-back gain is within one standard error of the difference.
std::vector<std::string> confusedWith(const Search& s, const Trial& best, const std::vector<Trial>& trials) {
  std::vector<std::string> names;
  for (const Trial& t : trials) {
    const std::string name = t.hypothesis.place.candidate->name();
    if (name == best.hypothesis.place.candidate->name() || name == "unnamed") continue;
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    if (best.partial_gain.size() != t.partial_gain.size()) continue;  // held back in other pieces: one is local
    if ((best.by_joint ? t.joint_gain : t.partial_gain).mean() < kNearlyAsGood * best.mean_gain ||
        !objection(s, t).empty())
      continue;
    double mean = 0.0, error = 0.0;
    setMean(best.by_joint ? best.joint_gain - t.joint_gain : best.partial_gain - t.partial_gain, mean, error);
    if (mean <= error) names.push_back(name);
  }
  return names;
}

double pOf(const NullDistribution& null, const Trial& t) {
  return monteCarloP(null.largest, null.standardized(t.hypothesis.place, t.share));
}

FoundEffect found(const Search& s, const Trial& t, const NullDistribution& null) {
  FoundEffect e;
  e.hypothesis = t.hypothesis;
  e.p = pOf(null, t);
  const Eigen::VectorXd after = rmsOf(s.data->stack, t.fit.residual_N);
  e.explained_rms_N = (s.rms_N.cwiseAbs2() - after.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  e.null_rms_N = null.threshold(t.hypothesis.place) * s.rms_N;
  const double total = s.fit.held_back.sum();
  const double blocks = static_cast<double>(t.gain.size());
  e.gain = t.mean_gain * blocks / total;
  e.gain_error = t.gain_error * blocks / total;
  return e;
}

/// Drops effects that the others have made superfluous: without one of them held-back parts are predicted as well.
void prune(Search& s, std::size_t first) {
  for (std::size_t k = first; k + 1 < s.effects.size(); ++k) {
    if (s.effects[k].hypothesis.place.candidate->local()) continue;
    std::vector<Hypothesis> others = hypothesesOf(s.effects);
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    std::vector<Eigen::MatrixXd> rows;
    for (const Hypothesis& h : others)
      rows.push_back(effectRows(*s.data, h));
    const JointFit without = fitJointly(*s.data, *s.base, s.rms_N, others, rows);
    double mean = 0.0, error = 0.0;
    const JointFit with = [&] {
      const std::vector<Hypothesis> all = hypothesesOf(s.effects);
      std::vector<Eigen::MatrixXd> all_rows;
      for (const Hypothesis& h : all)
        all_rows.push_back(effectRows(*s.data, h));
      return fitJointly(*s.data, *s.base, s.rms_N, all, all_rows);
    }();
    setMean(without.held_back - with.held_back, mean, error);
    if (mean > error) continue;
    s.rejected.push_back(placeText(s.effects[k].hypothesis.place) + ": taken out again, later effects explain it");
    s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(k));
    refit(s);
    --k;
  }
}

/// One more effect. False when nothing passes.
bool addOne(Search& s, const CandidateList& candidates, std::uint64_t seed) {
  const std::vector<Hypothesis> accepted = hypothesesOf(s.effects);
  std::vector<Hypothesis> tried = listHypotheses(candidates, s.data->inputs);
  tried.erase(std::remove_if(tried.begin(), tried.end(),
                             [&](const Hypothesis& h) {
                               return std::any_of(accepted.begin(), accepted.end(),
                                                  [&](const Hypothesis& a) { return a.place == h.place; });
                             }),
              tried.end());
  if (tried.empty() || !((s.rms_N.array() > kAboveFloor * s.floor.rms_N.array()).any())) return false;
  std::vector<Eigen::MatrixXd> rows;
  for (const Hypothesis& h : accepted)
    rows.push_back(effectRows(*s.data, h));
  s.fit = fitJointly(*s.data, *s.base, s.rms_N, accepted, rows);
  const Projection projection =
      project(modelColumns(*s.data, s.rms_N, accepted), weighted(s.data->stack, s.data->force_rows, s.rms_N));
  std::vector<Trial> trials = rankPlaces(s, projection, tried);
  trials.resize(std::min(trials.size(), kCompared));
  for (Trial& t : trials) {
    refineShape(s, projection, tried, t);
    crossValidate(s, projection, rows, t);
  }
  std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.gain.sum() > b.gain.sum(); });
  std::vector<const Trial*> passing;
  std::vector<Hope> hopes;
  for (const Trial& t : trials) {
    const std::string against = objection(s, t);
    if (!against.empty()) {
      s.rejected.push_back(placeText(t.hypothesis.place) + ": " + against);
      continue;
    }
    passing.push_back(&t);
    hopes.emplace_back(t.hypothesis.place, t.share);
  }
  if (passing.empty()) return false;
  s.options->progress("comparing with clean twins");
  const NullDistribution null = nullDistribution(*s.twins, *s.data, s.fit.residual_N, s.rms_N, accepted, tried, hopes,
                                                 kLargestP, s.options->draws, seed);
  for (const Trial* t : passing) {
    if (null.hopeless || pOf(null, *t) > kLargestP) {
      s.rejected.push_back(placeText(t->hypothesis.place) +
                           ": clean twins explain as much by chance (p = " + shortNumber(pOf(null, *t), 2) + ")");
      continue;
    }
    FoundEffect e = found(s, *t, null);
    e.indistinguishable_from = confusedWith(s, *t, trials);
    s.effects.push_back(e);
    s.options->progress("found " + placeText(e.hypothesis.place));
    return true;
  }
  return false;
}

}  // namespace

void searchForward(Search& s, const CandidateList& candidates, int most, std::uint64_t seed) {
  const std::size_t before = s.effects.size();
  while (s.effects.size() < before + static_cast<std::size_t>(most)) {
    s.rejected.clear();  // only why the search ended is of interest
    if (!addOne(s, candidates, seed + s.effects.size())) return;
    refit(s);
    prune(s, before);
    rebase(s);
    s.options->progress("simulating twins that have what was found");
    s.rebuild_twins();
  }
}

}  // namespace knee_robot::tracing
