#include "taken_for.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "among_found.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

/// Standard errors: the shapes of what gives way were chosen along the same blocks, what it gives way to has none.
constexpr double kSurelyWorse = 2.0;
constexpr double kNotTold = 1.0;  ///< from which both names are given

bool isTakenFor(const FoundEffect& e, const std::string& simpler) {
  return !std::isnan(e.p) && e.band_hz == 0.0 && e.hypothesis.place.candidate->takenFor() == simpler;
}

std::set<std::string> simplerNames(const Search& s) {
  std::set<std::string> names;
  for (const FoundEffect& e : s.effects) {
    const std::string simpler = e.hypothesis.place.candidate->takenFor();
    if (!simpler.empty() && isTakenFor(e, simpler)) names.insert(simpler);
  }
  return names;
}

/// The library's hypothesis by this name on this actuator, where nothing of it is in the model; null: none.
const Hypothesis* openOne(const Search& s, const std::string& name, int actuator) {
  for (const PlaceColumns& columns : s.library->places()) {
    FoundEffect one;
    one.hypothesis.place = columns.place();
    if (columns.place().candidate->name() == name && columns.place().actuator == actuator && !isAmong(s.effects, one))
      return &columns.tried.front();
  }
  return nullptr;
}

/// Puts it in the place of what is taken for it. False: it has no place there.
bool replaceBy(Search& s, const std::string& simpler) {
  for (FoundEffect& e : s.effects) {
    if (!isTakenFor(e, simpler)) continue;
    const Hypothesis* const one = openOne(s, simpler, e.hypothesis.place.actuator);
    if (one == nullptr) return false;
    e.hypothesis = *one;
  }
  refit(s);
  rebase(s);
  return true;
}

/// All of this name have a size of a sign that physics allows, to all blocks.
bool holds(const Search& s, const std::string& name) {
  for (std::size_t k = 0; k < s.effects.size(); ++k) {
    const FoundEffect& e = s.effects[k];
    const Candidate& candidate = *e.hypothesis.place.candidate;
    if (candidate.name() == name && !(s.fit.stable[k] && candidate.plausible(e.coefficients))) return false;
  }
  return true;
}

void noteReplaced(Search& s, const std::vector<FoundEffect>& before, const std::string& simpler,
                  const HeldBackGain& lost) {
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (!isTakenFor(before[k], simpler)) continue;
    const std::string name = before[k].hypothesis.place.candidate->name();
    s.effects[k].explained_rms_N = explainedBy(s, k);
    std::vector<std::string>& others = s.effects[k].indistinguishable_from;
    others.erase(std::remove(others.begin(), others.end(), simpler), others.end());
    if (lost.mean > kNotTold * lost.error) others.push_back(name);
    s.taken_out.push_back(placeText(before[k].hypothesis.place) + ": " + simpler +
                          " explains as much, beside the law near rest that goes with it");
  }
}

}  // namespace

void preferSimpler(Search& s) {
  for (const std::string& simpler : simplerNames(s)) {
    const std::vector<FoundEffect> before = s.effects;
    const BaseFit base = *s.base;
    const Eigen::VectorXd noise_N = s.rms_N;
    rebase(s);  // both with laws of their own: shapes have been refined since these were chosen
    const Eigen::VectorXd with = heldBackInAll(s, noise_N);
    if (replaceBy(s, simpler) && holds(s, simpler)) {
      const HeldBackGain lost = heldBackGain(heldBackInAll(s, noise_N) - with);
      if (lost.mean <= kSurelyWorse * lost.error) {
        noteReplaced(s, before, simpler, lost);
        continue;
      }
    }
    s.effects = before;
    adoptBase(s, base);
  }
}

}  // namespace knee_robot::tracing
