// What stays in the model: decided on held-back training data.

#include "decide.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "near_rest.h"
#include "refine.h"
#include "refit.h"
#include "stretches.h"
#include "trial.h"
#include "whole_size.h"

namespace knee_robot::tracing {
namespace {

constexpr double kStayErrors =
    1.0;  ///< standard errors by which a member must help beside the others, all fitted together
constexpr double kNestedErrors = 2.0;  ///< the same with only itself fitted
constexpr double kSizeErrors = 3.0;    ///< standard errors by which the size of an effect must differ from none

/// How surely each effect is needed beside the others, in standard errors of its held-back gain; at least 1: it stays.
std::vector<double> needs(const Search& s) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  const JointProblem problem = problemOf(s, all);
  const Eigen::VectorXd with = problem.heldBack();
  const Projector projector(projectedColumns(s, all), weighted(s.data->stack, s.data->force_rows, s.rms_N),
                            s.base->pull);
  std::vector<Eigen::Index> first(1, s.base->coordinates());  // column of each effect
  for (const Hypothesis& h : all)
    first.push_back(first.back() +
                    static_cast<Eigen::Index>(h.place.candidate->coefficients(s.data->inputs.front()).size()));
  const auto sure = [](const HeldBackGain& g) { return g.mean / std::max(1e-300, g.error); };
  std::vector<double> out(all.size(), std::numeric_limits<double>::infinity());
  inParallel(all.size(), [&](std::size_t k) {
    if (s.effects[k].band_hz > 0.0) return;
    const Candidate& candidate = *all[k].place.candidate;
    const HeldBackGain nested =
        heldBackGain(nestedGain(s, projector.without(first[k], first[k + 1] - first[k]), {all[k]}));
    if (candidate.local()) {  // held-back pieces of the part in which it acts, as when it is added
      out[k] = nested.gaining >= kMostPieces ? sure(nested) : 0.0;
      return;
    }
    const HeldBackGain joint = heldBackGain(problem.heldBackWithout(k) - with);
    out[k] = std::max(sure(joint) / kStayErrors, sure(nested) / kNestedErrors) / (candidate.isMap() ? kMapErrors : 1.0);
  });
  return out;
}

/// What effect k saves on held-back stretches of its own actuator's positions.
HeldBackGain gainAtOtherPositions(Search& s, std::size_t k, Attention attention) {
  const Stack own = s.data->stack;
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  setAttention(*s.data, attention);
  labelBy(positionsOf(s.data->recordings, own).col(all[k].place.actuator), s.data->stack);
  const JointProblem problem = problemOf(s, all);
  const HeldBackGain gain = heldBackGain(problem.heldBackWithout(k) - problem.heldBack());
  s.data->stack = own;
  setAttention(*s.data, s.attention);
  return gain;
}

}  // namespace

void eliminateBackward(Search& s) {
  while (s.effects.size() > 1) {
    const std::vector<double> need = needs(s);
    const std::size_t worst = static_cast<std::size_t>(std::min_element(need.begin(), need.end()) - need.begin());
    if (need[worst] >= 1.0) return;
    s.taken_out.push_back(placeText(s.effects[worst].hypothesis.place) + ": taken out again, the others explain it");
    s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(worst));
    refit(s);
  }
}

void dropWhatDoesNotRepeat(Search& s) {
  for (std::size_t k = s.effects.size(); k-- > 0;) {
    const Place place = s.effects[k].hypothesis.place;
    if (!place.candidate->periodic()) continue;
    // The remainders of stops lie at the same places in every repeat: a ripple shows on the way between them, too.
    for (const Attention attention : {Attention::All, Attention::Moving}) {
      const HeldBackGain gain = gainAtOtherPositions(s, k, attention);
      if (gain.mean > kStayErrors * gain.error) continue;
      s.taken_out.push_back(placeText(place) + ": does not help on held-back stretches of its positions" +
                            (attention == Attention::Moving ? " while axes move" : "") + " (mean " +
                            shortNumber(gain.mean, 3) + " +- " + shortNumber(gain.error, 3) + ")");
      s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(k));
      refit(s);
      break;
    }
  }
}

void dropImplausible(Search& s) {
  const auto shaped = [](const FoundEffect& e) {
    return e.hypothesis.place.candidate->plausibleShape(e.hypothesis.shape);
  };
  const auto bad = std::stable_partition(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return std::isnan(e.p) || (shaped(e) && e.hypothesis.place.candidate->plausible(e.coefficients));
  });
  if (bad == s.effects.end()) return;
  for (auto e = bad; e != s.effects.end(); ++e)
    s.taken_out.push_back(placeText(e->hypothesis.place) + (shaped(*e) ? ": no machine has the size that fits"
                                                                       : ": the shape that fits is not physical"));
  s.effects.erase(bad, s.effects.end());
  refit(s);
}

void dropUnsized(Search& s) {
  const auto sureness = [](const FoundEffect& e) {
    if (std::isnan(e.p) || e.band_hz > 0.0 || e.coefficients.size() != 1 || !std::isfinite(e.std[0]))
      return std::numeric_limits<double>::infinity();
    return std::abs(e.coefficients[0]) / std::max(1e-300, e.std[0]);
  };
  while (!s.effects.empty()) {
    const auto least = std::min_element(s.effects.begin(), s.effects.end(),
                                        [&](const auto& a, const auto& b) { return sureness(a) < sureness(b); });
    if (sureness(*least) >= kSizeErrors) return;
    const Candidate& candidate = *least->hypothesis.place.candidate;
    s.taken_out.push_back(placeText(least->hypothesis.place) +
                          ": its size is not known beside the baseline and the other effects (" +
                          candidate.coefficients(s.data->inputs.front())[0].name + " " +
                          shortNumber(least->coefficients[0], 3) + " +- " + shortNumber(least->std[0], 3) + ")");
    s.effects.erase(least);
    refit(s);
  }
}

void standAlone(Search& s, const Place& place) {
  // What looks like much may stand for what the others are.
  if (!place.candidate->shared() || place.candidate->local() || place.candidate->looksLikeMuch()) return;
  const auto stays = [&](const FoundEffect& e) {
    return e.hypothesis.place == place || std::isnan(e.p) || e.band_hz > 0.0;
  };
  const std::vector<FoundEffect> together = s.effects;
  if (std::all_of(together.begin(), together.end(), stays)) return;
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto heldBack = [&] {
    s.rms_N = noise_N;  // both weighted alike
    return problemOf(s, hypothesesOf(s.effects)).heldBack();
  };
  refineShapes(s);
  const std::vector<FoundEffect> refined = s.effects;
  const Eigen::VectorXd with = heldBack();
  s.effects.erase(std::stable_partition(s.effects.begin(), s.effects.end(), stays), s.effects.end());
  refit(s);
  refineShapes(s);
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    if (s.effects[k].hypothesis.place == place) s.effects[k].explained_rms_N = explainedBy(s, k);
  }
  const HeldBackGain lost = heldBackGain(heldBack() - with);
  if (lost.mean > kStayErrors * lost.error) {
    s.effects = refined;
  } else {
    for (const FoundEffect& e : together) {
      if (!stays(e))
        s.taken_out.push_back(placeText(e.hypothesis.place) + ": taken out again, " + placeText(place) +
                              " alone explains as much");
    }
  }
  refit(s);
}

namespace {

/// What parameters of the same name have in a shape of what generalizes it; empty: it has others, too.
std::vector<double> namesakes(const Hypothesis& general, const Candidate& special) {
  const std::vector<ShapeParameter> all = general.place.candidate->shapeParameters();
  std::vector<double> out;
  for (const ShapeParameter& p : special.shapeParameters()) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const ShapeParameter& a) { return a.name == p.name; });
    if (same == all.end()) return {};
    out.push_back(general.shape[static_cast<std::size_t>(same - all.begin())]);
  }
  return out;
}

/// The shape of the library that explains most in the place of effect `k`, with its whole size.
std::vector<double> wholeOf(const Search& s, std::size_t k, const PlaceColumns& p) {
  const Projection beside = projectModel(s, without(hypothesesOf(s.effects), k));
  Eigen::Index best = 0;
  explained(makeProbes(*s.data, p.tried, p.rows, p.first_row, beside, s.rms_N), beside.residual).col(0).maxCoeff(&best);
  return ofWholeSize(s, beside, p.tried[static_cast<std::size_t>(best)]).shape;
}

/// The special case with the shape of what generalizes it; where its shape has other parameters, with the one, of its
/// own and where the general one is, that predicts held-back blocks best in the place of effect `k`.
Hypothesis specialCase(const Search& s, std::size_t k, const PlaceColumns& special) {
  const std::vector<double>& shape = s.effects[k].hypothesis.shape;
  Hypothesis best = special.tried.front();
  best.place = *openPlace(s, special.place(), nullptr);
  if (best.shape.size() == shape.size()) return {best.place, shape};
  std::vector<std::vector<double>> shapes;
  for (const Hypothesis& tried : special.tried)
    shapes.push_back(tried.shape);
  const std::vector<double> there = namesakes(s.effects[k].hypothesis, *best.place.candidate);
  if (!there.empty()) shapes.push_back(there);
  if (best.place.actuator != s.effects[k].hypothesis.place.actuator) shapes = {wholeOf(s, k, special)};
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& tried : shapes) {
    std::vector<Hypothesis> all = hypothesesOf(s.effects);
    all[k] = {best.place, tried};
    const double left = problemOf(s, all).heldBack().sum();
    if (left < least) best.shape = tried;
    least = std::min(least, left);
  }
  return best;
}

/// Where the special case of effect `k` is: what it generalizes, at its place; of what all actuators have, the one
/// actuator on which the same name explains most of what the others leave. Null: nowhere.
const PlaceColumns* specialPlace(const Search& s, std::size_t k) {
  const Place& general = s.effects[k].hypothesis.place;
  std::vector<const PlaceColumns*> of_one;
  for (const PlaceColumns& p : s.library->places()) {
    const Place& place = p.place();
    if (place.candidate->name() == general.candidate->generalizes() && place.actuator == general.actuator) return &p;
    if (general.actuator < 0 && place.actuator >= 0 && place.candidate->reachesOthers() &&
        place.candidate->name() == general.candidate->name())
      of_one.push_back(&p);
  }
  if (of_one.empty()) return nullptr;
  const Projection beside = projectModel(s, without(hypothesesOf(s.effects), k));
  const auto most = [&](const PlaceColumns* p) {
    return explained(makeProbes(*s.data, p->tried, p->rows, p->first_row, beside, s.rms_N), beside.residual).maxCoeff();
  };
  return *std::max_element(of_one.begin(), of_one.end(),
                           [&](const auto* a, const auto* b) { return most(a) < most(b); });
}

/// Held-back squares, in units of what is left a row, that the additional shape parameters of the first would save by
/// chance: one each, since they were refined on what is held back, too.
double byChance(const Hypothesis& general, const Hypothesis& special) {
  return std::max(0.0, static_cast<double>(general.shape.size()) - static_cast<double>(special.shape.size()));
}

}  // namespace

void simplify(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const Place general = s.effects[k].hypothesis.place;
    const PlaceColumns* special = specialPlace(s, k);
    if (special == nullptr || std::isnan(s.effects[k].p) || !openPlace(s, special->place(), nullptr)) continue;
    const std::vector<FoundEffect> before = s.effects;
    const Eigen::VectorXd noise_N = s.rms_N, with = problemOf(s, hypothesesOf(s.effects)).heldBack();
    s.effects[k].hypothesis = specialCase(s, k, *special);
    refit(s);
    refineShapes(s);
    const bool plausible = s.fit.stable[k] && special->place().candidate->plausible(s.effects[k].coefficients);
    s.rms_N = noise_N;  // both weighted alike
    const double lost = problemOf(s, hypothesesOf(s.effects)).heldBack().sum() - with.sum();
    if (!plausible || lost > byChance(before[k].hypothesis, s.effects[k].hypothesis)) {
      s.effects = before;
    } else {
      s.taken_out.push_back(placeText(general) + ": " + special->place().candidate->name() +
                            ", a special case of it, explains as much");
    }
    refit(s);
  }
}

void replaceMaps(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const Place map = s.effects[k].hypothesis.place;
    if (!map.candidate->isMap() || map.candidate->shared()) continue;
    const std::vector<Hypothesis> all = hypothesesOf(s.effects);
    const Eigen::VectorXd with = problemOf(s, all).heldBack();
    for (const Hypothesis& other : all) {
      if (other.place.candidate->isMap() || other.place.candidate->shared()) continue;
      const Hypothesis named = {{other.place.candidate, map.actuator}, other.shape};
      if (std::any_of(all.begin(), all.end(), [&](const Hypothesis& h) { return h.place == named.place; })) continue;
      std::vector<Hypothesis> instead = all;
      instead[k] = named;
      const JointFit fit = fitOf(s, instead);
      const HeldBackGain lost = heldBackGain(fit.held_back - with);
      if (lost.mean > kStayErrors * lost.error || !fit.stable[k] ||
          !named.place.candidate->plausible(fit.coefficients[k]))
        continue;
      s.taken_out.push_back(placeText(map) + ": " + named.place.candidate->name() +
                            ", which was found on another actuator, explains it as well");
      s.effects[k].hypothesis = named;
      refit(s);
      break;
    }
  }
}

}  // namespace knee_robot::tracing
