// What stays in the model, and what of it is predicted in other recordings. Both are decided on held-back training data.

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "knee_robot/base/numbers.h"
#include "trial.h"

namespace knee_robot::tracing {
namespace {

constexpr double kErrors = 1.0;  ///< standard errors by which a member must help beside the others, all fitted together
constexpr double kNestedErrors = 2.0;  ///< the same with only itself fitted
constexpr double kMapErrors = 2.5;     ///< so many times that for a map, as when it is added
constexpr int kStretches = 6;          ///< of positions, along each of two directions

std::vector<Hypothesis> without(std::vector<Hypothesis> all, std::size_t k) {
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(k));
  return all;
}

/// How surely effect k is needed beside the others, in standard errors of its held-back gain; at least 1: it stays.
double needOf(const Search& s, const JointFit& with, std::size_t k) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects), others = without(all, k);
  const JointFit fit = fitOf(s, others);
  const HeldBackGain joint = heldBackGain(fit.held_back - with.held_back);
  const Projection projection = projectModel(s, others);
  const HeldBackGain nested = heldBackGain(nestedGain(s, projection, {all[k]}));
  const auto sure = [](const HeldBackGain& g) { return g.mean / std::max(1e-300, g.error); };
  const double bends = all[k].place.candidate->name() == "unnamed" ? kMapErrors : 1.0;
  return std::max(sure(joint) / kErrors, sure(nested) / kNestedErrors) / bends;
}

/// Positions of all actuators at the picks.
Eigen::MatrixXd positionsOf(const std::vector<identification::Observation>& recordings, const Stack& stack) {
  Eigen::MatrixXd positions(stack.size(), stack.axes);
  for (Eigen::Index n = 0; n < stack.size(); ++n) {
    const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
    positions.row(n) = recordings[pick.recording].signals.position_m.row(pick.sample);
  }
  return positions;
}

/// Numbers the picks in equal shares by a coordinate.
void labelBy(const Eigen::VectorXd& along, Stack& stack) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(stack.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return along[a] < along[b]; });
  for (std::size_t k = 0; k < order.size(); ++k)
    stack.picks[static_cast<std::size_t>(order[k])].block = static_cast<int>(k * kStretches / order.size());
  stack.blocks = kStretches;
}

/// By where the robot was, along one principal direction of the actuators' positions.
void labelByPosition(const std::vector<identification::Observation>& recordings, int direction, Stack& stack) {
  Eigen::MatrixXd positions = positionsOf(recordings, stack);
  positions.rowwise() -= positions.colwise().mean().eval();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(positions.transpose() * positions, Eigen::ComputeFullU);
  labelBy(positions * svd.matrixU().col(std::min(direction, stack.axes - 1)), stack);
}

/// What effect k saves on held-back stretches of its own actuator's positions.
HeldBackGain gainAtOtherPositions(Search& s, std::size_t k) {
  const Stack own = s.data->stack;
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  labelBy(positionsOf(s.data->recordings, own).col(all[k].place.actuator), s.data->stack);
  const HeldBackGain gain = heldBackGain(fitOf(s, without(all, k)).held_back - fitOf(s, all).held_back);
  s.data->stack = own;
  return gain;
}

bool judged(const FoundEffect& e) {
  return e.hypothesis.place.candidate->transfers() && !e.hypothesis.place.candidate->local() && e.band_hz == 0.0;
}

}  // namespace

void eliminateBackward(Search& s) {
  while (s.effects.size() > 1) {
    const JointFit with = fitOf(s, hypothesesOf(s.effects));
    std::size_t worst = 0;
    double least = 1.0;
    for (std::size_t k = 0; k < s.effects.size(); ++k) {
      if (s.effects[k].hypothesis.place.candidate->local() || s.effects[k].band_hz > 0.0) continue;
      const double need = needOf(s, with, k);
      if (need >= least) continue;
      least = need;
      worst = k;
    }
    if (least >= 1.0) return;
    s.rejected.push_back(placeText(s.effects[worst].hypothesis.place) + ": taken out again, the others explain it");
    s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(worst));
    refit(s);
  }
}

void dropWhatDoesNotRepeat(Search& s) {
  for (std::size_t k = s.effects.size(); k-- > 0;) {
    const Place place = s.effects[k].hypothesis.place;
    if (!place.candidate->periodic()) continue;
    const HeldBackGain gain = gainAtOtherPositions(s, k);
    if (gain.mean > kErrors * gain.error) continue;
    s.rejected.push_back(placeText(place) + ": does not help on held-back stretches of its positions (mean " +
                         shortNumber(gain.mean, 3) + " +- " + shortNumber(gain.error, 3) + ")");
    s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(k));
    refit(s);
  }
}

void replaceMaps(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const Place map = s.effects[k].hypothesis.place;
    if (map.candidate->name() != "unnamed") continue;
    const std::vector<Hypothesis> all = hypothesesOf(s.effects);
    const Eigen::VectorXd with = fitOf(s, all).held_back;
    for (const Hypothesis& other : all) {
      if (other.place.candidate->name() == "unnamed" || other.place.candidate->shared()) continue;
      const Hypothesis named = {{other.place.candidate, map.actuator}, other.shape};
      if (std::any_of(all.begin(), all.end(), [&](const Hypothesis& h) { return h.place == named.place; })) continue;
      std::vector<Hypothesis> instead = all;
      instead[k] = named;
      const JointFit fit = fitOf(s, instead);
      const HeldBackGain lost = heldBackGain(fit.held_back - with);
      if (lost.mean > kErrors * lost.error || !fit.stable[k] || !named.place.candidate->plausible(fit.coefficients[k]))
        continue;
      s.rejected.push_back(placeText(map) + ": " + named.place.candidate->name() +
                           ", which was found on another actuator, explains it as well");
      s.effects[k].hypothesis = named;
      refit(s);
      break;
    }
  }
}

void judgeElsewhere(Search& s, std::vector<std::string>& notes) {
  const Stack own = s.data->stack;
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  std::vector<double> saved(all.size(), 0.0);
  double total = 0.0;
  for (const int direction : {0, 1}) {
    labelByPosition(s.data->recordings, direction, s.data->stack);
    const double with = fitOf(s, all).held_back.sum();
    total += with;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (judged(s.effects[k])) saved[k] += fitOf(s, without(all, k)).held_back.sum() - with;
    }
  }
  s.data->stack = own;
  for (std::size_t k = 0; k < all.size(); ++k) {
    FoundEffect& e = s.effects[k];
    if (!judged(e)) continue;
    e.elsewhere_gain = saved[k] / std::max(1e-300, total);
    if (saved[k] >= 0.0) continue;
    e.transfers = false;
    notes.push_back(placeText(e.hypothesis.place) +
                    ": at held-back positions of the training recordings it makes the error larger (by " +
                    shortNumber(-100.0 * e.elsewhere_gain, 2) +
                    " % of the squares); it is left out of predictions elsewhere.");
  }
}

}  // namespace knee_robot::tracing
