#include "replace_pair.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSurelyBetter = 2.0;
constexpr std::size_t kMostRivals = 2;       ///< that are said
constexpr double kAsLikely = 0.75;           ///< two effects of which the recordings do not tell whether they are one
constexpr std::size_t kFewestActuators = 2;  ///< with both kinds: on one, two effects are no less likely than one
constexpr std::size_t kMostOfThem =
    2;  ///< both kinds are on one of so many actuators that have the older one, at least

bool mayGo(const FoundEffect& e) {
  return !std::isnan(e.p) && e.band_hz == 0.0;
}

std::set<int> actuatorsOf(const Search& s, const std::string& name) {
  std::set<int> out;
  for (const FoundEffect& e : s.effects) {
    const Place& place = e.hypothesis.place;
    if (place.candidate->name() == name && place.actuator >= 0 && mayGo(e)) out.insert(place.actuator);
  }
  return out;
}

/// Whether the two kinds sit on the same actuators, nearly.
bool isPair(const std::set<int>& special, const std::set<int>& other) {
  return other.size() >= kFewestActuators && kMostOfThem * other.size() >= special.size() &&
         std::includes(special.begin(), special.end(), other.begin(), other.end());
}

/// The model with the general kind in the place of both, on the older one's actuators.
void putInTheirPlace(Search& s, const Candidate* general, const std::string& special, const std::string& other) {
  std::vector<FoundEffect> instead;
  for (const PlaceColumns& p : s.library->places()) {
    for (const FoundEffect& e : s.effects) {
      const Place& own = e.hypothesis.place;
      if (p.place().candidate != general || p.place().actuator != own.actuator || own.candidate->name() != special ||
          !mayGo(e))
        continue;
      instead.push_back(e);
      instead.back().hypothesis = p.tried.front();
    }
  }
  const auto goes = [&](const FoundEffect& e) {
    const std::string name = e.hypothesis.place.candidate->name();
    return mayGo(e) && (name == special || name == other);
  };
  s.effects.erase(std::remove_if(s.effects.begin(), s.effects.end(), goes), s.effects.end());
  s.effects.insert(s.effects.end(), instead.begin(), instead.end());
  refit(s);
}

bool isPlausible(const Search& s, const Candidate* general) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const FoundEffect& e = s.effects[k];
    if (e.hypothesis.place.candidate != general) continue;
    if (!s.fit.stable[k] || !general->plausible(e.coefficients) || e.coefficients.cwiseAbs().maxCoeff() == 0.0)
      return false;
  }
  return true;
}

/// The recordings do not tell the two from the one.
void doubtBoth(Search& s, const std::string& general, const std::string& special, const std::string& other) {
  for (FoundEffect& e : s.effects) {
    const std::string name = e.hypothesis.place.candidate->name();
    std::vector<std::string>& rivals = e.indistinguishable_from;
    if (!mayGo(e) || (name != special && name != other) || rivals.size() >= kMostRivals ||
        std::find(rivals.begin(), rivals.end(), general) != rivals.end())
      continue;
    rivals.push_back(general);
    e.probability = std::min(e.probability, kAsLikely);
  }
}

void tryInTheirPlace(Search& s, const Candidate* general, const std::string& other) {
  const std::string special = general->generalizes();
  const std::vector<FoundEffect> together = s.effects;
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto heldBack = [&] {
    s.rms_N = noise_N;  // all weighted alike
    return problemOf(s, hypothesesOf(s.effects)).heldBack();
  };
  const Eigen::VectorXd with = heldBack();
  putInTheirPlace(s, general, special, other);
  const HeldBackGain lost = heldBackGain(heldBack() - with);
  const bool plausible = isPlausible(s, general);
  if (plausible && lost.mean < -kSurelyBetter * lost.error) {
    for (std::size_t k = 0; k < s.effects.size(); ++k) {
      if (s.effects[k].hypothesis.place.candidate != general) continue;
      s.effects[k].explained_rms_N = explainedBy(s, k);
      s.effects[k].indistinguishable_from.clear();
    }
    s.taken_out.push_back(special + " and " + other + ": taken out again, " + general->name() +
                          " alone explains more than both");
  } else {
    s.effects = together;
    if (plausible && lost.mean <= lost.error) doubtBoth(s, general->name(), special, other);
  }
  refit(s);
}

}  // namespace

void replacePair(Search& s, const Candidate* found) {
  std::vector<const Candidate*> generals;
  for (const PlaceColumns& p : s.library->places()) {
    const Candidate* c = p.place().candidate;
    const bool is_new = std::find(generals.begin(), generals.end(), c) == generals.end();
    if (is_new && !c->shared() && !c->isMap() && !c->generalizes().empty() && c != found) generals.push_back(c);
  }
  for (const Candidate* general : generals) {
    const std::string special = general->generalizes();
    if (special == found->name() || !actuatorsOf(s, general->name()).empty()) continue;
    if (isPair(actuatorsOf(s, special), actuatorsOf(s, found->name()))) tryInTheirPlace(s, general, found->name());
  }
}

}  // namespace knee_robot::tracing
