// What of the additions is no attribution: what does not hold at positions of its own recordings that were held back.

#include "abstain.h"

#include <algorithm>
#include <cmath>

#include "elsewhere.h"
#include "refit.h"

namespace knee_robot::tracing {
namespace {

/// Noise floors that what does not help at held-back positions explains at least, whatever it is: right ones that explained
/// less, 0.3 to 0.8 on three machines, helped there.
constexpr double kWithoutHelp = 1.0;

/// Held-back positions say something about it.
bool judgedElsewhere(const FoundEffect& e) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  return e.transfers && !candidate.goesWithTime() && candidate.elsewhere(e.coefficients).size() > 0;
}

/// The effect that does most harm at held-back positions; none: the end.
std::vector<FoundEffect>::iterator worstElsewhere(std::vector<FoundEffect>& effects) {
  auto worst = effects.end();
  for (auto e = effects.begin(); e != effects.end(); ++e) {
    const bool fails = e->hypothesis.place.candidate->transfers() && !e->transfers && e->elsewhere_gain < 0.0;
    if (fails && (worst == effects.end() || e->elsewhere_gain < worst->elsewhere_gain)) worst = e;
  }
  return worst;
}

}  // namespace

void abstainElsewhere(Search& s, std::vector<std::string>& notes) {
  while (true) {
    std::vector<std::string> said;
    for (FoundEffect& e : s.effects)
      e.transfers = e.hypothesis.place.candidate->transfers();
    testElsewhere(s, said);
    const auto worst = worstElsewhere(s.effects);
    if (worst == s.effects.end()) return;
    const std::string place = placeText(worst->hypothesis.place);
    s.taken_out.push_back(place + ": does not hold at held-back positions");
    notes.push_back(place +
                    ": helps where it was fitted, but at held-back positions of the training recordings it makes the "
                    "error larger; it is not named. Record a motion that covers more positions and speeds.");
    s.effects.erase(worst);
    refit(s);
  }
}

namespace {

/// What it must exceed, N per actuator. Neither held-back positions nor, where no recording repeats another, repeats speak
/// for what goes with time or happened once: then what is left, however small the floor is estimated.
Eigen::ArrayXd leastOf(const Search& s, const FoundEffect& e) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  const bool failed = candidate.transfers() && !e.transfers && e.elsewhere_gain < kWorthElsewhere && !std::isnan(e.p);
  const Eigen::ArrayXd floors =
      std::max(candidate.leastFloors(), failed ? kWithoutHelp : 0.0) * s.floor.of_names_N.array();
  const bool unproven = !s.floor.measured && (candidate.goesWithTime() || candidate.local()) && !std::isnan(e.p);
  return unproven ? floors.max(s.rms_N.array()).eval() : floors;
}

}  // namespace

int leaveOutSmall(Search& s, bool helps, std::vector<std::string>& rejected) {
  const auto named = std::stable_partition(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return (helps && judgedElsewhere(e)) || (e.explained_rms_N.array() >= leastOf(s, e)).any();
  });
  const int taken_out = static_cast<int>(s.effects.end() - named);
  for (auto e = named; e != s.effects.end(); ++e)
    rejected.push_back(placeText(e->hypothesis.place) +
                       ": is no larger than the noise floor, or than what is left where nothing repeats, and does not "
                       "surely help at held-back positions");
  s.effects.erase(named, s.effects.end());
  return taken_out;
}

}  // namespace knee_robot::tracing
