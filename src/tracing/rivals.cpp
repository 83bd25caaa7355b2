#include "rivals.h"

#include <algorithm>
#include <cmath>

#include "doubt.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNearlyAsGood = 0.8;  ///< share of the best one's held-back gain at which a runner-up is a rival
constexpr double kRatherBetter = 0.7;  ///< probability from which a map is a rival of a name,
constexpr double kMuchBetter = 1.1;    ///< and its held-back gain over the name's: a law in more pieces gains a little

/// The one is a special case of the other: no alternative.
bool related(const Trial& a, const Trial& b) {
  return a.hypothesis.place.candidate->generalizes() == b.name() ||
         b.hypothesis.place.candidate->generalizes() == a.name();
}

/// Probability that a map on the same actuator explains what was held back better than a named effect: 0.44 at most of
/// 27 right names on eight machines (such maps contain their law), 0.76 and 0.995 of two wrong ones. A map over the
/// force that a drive has to give is no rival of what lies beyond the drive: that force tells the load and the direction
/// of travel alike, so that it follows laws of friction that nothing has fitted yet (0.99997 beside a right name). Nor is
/// one that surely gains, but little: 1.01 times as much beside two right names, 1.28 times beside a wrong one.
double probabilityOfMap(const Trial& named, const Trial& map) {
  const Place &a = named.hypothesis.place, &b = map.hypothesis.place;
  const bool comparable = !named.isMap() && map.isMap() && !related(named, map) &&
                          map.nested_gain.size() == named.nested_gain.size() && a.actuator == b.actuator &&
                          a.candidate->ofDrive() == b.candidate->ofDrive();
  if (!comparable || map.nested_gain.sum() < kMuchBetter * named.nested_gain.sum()) return 0.0;
  return probabilityPositive(map.nested_gain - named.nested_gain);
}

bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Something without a name is in the model that acts where it does: a wrong name would look right beside it.
bool besideAMap(const Search& s, const Place& place) {
  return std::any_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    const Place& other = e.hypothesis.place;
    const bool together = place.actuator < 0 || other.actuator < 0 || place.actuator == other.actuator;
    return other.candidate->isMap() && together;
  });
}

/// A map was its rival, or that of the place where its name was found first.
bool doubtedForAMap(const FoundEffect& e) {
  return !std::isnan(e.p) && !e.hypothesis.place.candidate->isMap() && isOneOf(e.indistinguishable_from, "unnamed");
}

}  // namespace

std::vector<std::string> rivalsOf(const Search& s, const Trial& best, const std::vector<Trial>& trials, bool sibling,
                                  double& probability) {
  std::vector<std::string> names;
  probability = 1.0;
  for (const Trial& t : trials) {
    const double map_is_better = probabilityOfMap(best, t);
    if (map_is_better > kRatherBetter && objection(s, t, sibling).empty()) {
      probability = std::min(probability, 1.0 - map_is_better);
      if (!isOneOf(names, t.name())) names.push_back(t.name());
    }
    const Place &a = best.hypothesis.place, &b = t.hypothesis.place;
    const bool together = a.actuator < 0 || b.actuator < 0 || a.actuator == b.actuator;
    if (!together || t.name() == best.name() || t.isMap() || best.isMap() || related(t, best)) continue;
    if (t.nested_gain.size() != best.nested_gain.size()) continue;  // held back in other pieces: one is local
    if (t.nested_gain.sum() < kNearlyAsGood * best.nested_gain.sum() || !objection(s, t, sibling).empty()) continue;
    const double sure = probabilityPositive(best.nested_gain - t.nested_gain);
    probability = std::min(probability, sure);
    if (sure < kSureOfName && !isOneOf(names, t.name())) names.push_back(t.name());
  }
  return names;
}

void reconsiderRivals(Search& s) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const FoundEffect& named = s.effects[k];
    if (std::isnan(named.p) || named.hypothesis.place.candidate->isMap() || named.indistinguishable_from.empty() ||
        (doubtedForAMap(named) && besideAMap(s, named.hypothesis.place)))
      continue;
    FoundEffect e = s.effects[k];
    s.effects.erase(s.effects.begin() + static_cast<std::ptrdiff_t>(k));
    refit(s);
    const Ranking ranking = rankPlaces(s, nullptr);
    const auto trial = std::find_if(ranking.trials.begin(), ranking.trials.end(),
                                    [&](const Trial& t) { return t.hypothesis.place == e.hypothesis.place; });
    if (trial != ranking.trials.end() && objection(s, *trial, false).empty()) {
      e.indistinguishable_from = rivalsOf(s, *trial, ranking.trials, false, e.probability);
      e.doubted = e.probability < kEven && isOneOf(e.indistinguishable_from, "unnamed");
    }
    s.effects.insert(s.effects.begin() + static_cast<std::ptrdiff_t>(k), e);
    refit(s);
  }
}

}  // namespace knee_robot::tracing
