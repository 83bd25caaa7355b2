#include "replace_kin.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "near_rest.h"
#include "refine.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

std::string kindOf(const Candidate& c) {
  return c.generalizes().empty() ? c.name() : c.generalizes();
}

/// Older ones of the same kind, or of single actuators what all of them have; not those of a given model, or of another
/// band.
bool isKin(const FoundEffect& e, const Place& place) {
  const Place& own = e.hypothesis.place;
  const bool together = own.actuator == place.actuator || (place.actuator < 0 && own.candidate->reachesOthers());
  return !(own == place) && together && kindOf(*own.candidate) == kindOf(*place.candidate) && !std::isnan(e.p) &&
         e.band_hz == 0.0;
}

/// The shape of the library that explains most of what the model leaves as it stands.
Hypothesis bestOfLibrary(const Search& s, const PlaceColumns& columns) {
  const Projection projection = projectModel(s, hypothesesOf(s.effects));
  Eigen::Index best = 0;
  explained(makeProbes(*s.data, columns.tried, columns.rows, columns.first_row, projection, s.rms_N),
            projection.residual)
      .col(0)
      .maxCoeff(&best);
  return columns.tried[static_cast<std::size_t>(best)];
}

using Goes = std::function<bool(const FoundEffect&)>;

/// The model with this effect, by what is known of `own`, in the place of those that go, its shape searched for anew and
/// refined.
void putAlone(Search& s, const FoundEffect& own, const PlaceColumns& columns, const Goes& goes) {
  FoundEffect alone = own;
  s.effects.erase(std::remove_if(s.effects.begin(), s.effects.end(), goes), s.effects.end());
  refit(s);
  alone.hypothesis = bestOfLibrary(s, columns);
  s.effects.push_back(alone);
  refit(s);
  refineShapes(s);
  s.effects.back().explained_rms_N = explainedBy(s, s.effects.size() - 1);
}

/// Puts it alone, and says whether held-back blocks are predicted as well then, within a standard error.
bool predictsAlone(Search& s, const FoundEffect& own, const PlaceColumns& columns, const Goes& goes) {
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto heldBack = [&] {
    s.rms_N = noise_N;  // all weighted alike
    return problemOf(s, hypothesesOf(s.effects)).heldBack();
  };
  const Eigen::VectorXd with = heldBack();
  putAlone(s, own, columns, goes);
  const HeldBackGain lost = heldBackGain(heldBack() - with);
  const bool plausible = s.fit.stable.back() && columns.place().candidate->plausible(s.effects.back().coefficients);
  return lost.mean <= lost.error && plausible;
}

}  // namespace

void replaceKin(Search& s, const Place& place) {
  const auto& places = s.library->places();
  const auto columns =
      std::find_if(places.begin(), places.end(), [&](const PlaceColumns& p) { return p.place() == place; });
  const std::vector<FoundEffect> together = s.effects;
  const auto isOld = [&](const FoundEffect& e) { return isKin(e, place); };
  const auto own =
      std::find_if(together.begin(), together.end(), [&](const auto& e) { return e.hypothesis.place == place; });
  // What has no name takes no name's place.
  if (!place.candidate->shared() || place.candidate->isMap() || columns == places.end() || own == together.end() ||
      std::none_of(together.begin(), together.end(), isOld))
    return;
  const auto goes = [&](const FoundEffect& e) { return isOld(e) || e.hypothesis.place == place; };
  if (!predictsAlone(s, *own, *columns, goes)) {
    s.effects = together;
  } else {
    for (const FoundEffect& e : together) {
      if (isOld(e))
        s.taken_out.push_back(placeText(e.hypothesis.place) + ": taken out again, " + placeText(place) +
                              " alone explains as much");
    }
  }
  refit(s);
}

void nameMatrix(Search& s, const Place& found) {
  const std::string simpler = found.candidate->generalizes();
  if (!found.candidate->isMap() || !found.candidate->shared() || simpler.empty()) return;
  for (const PlaceColumns& columns : s.library->places()) {
    const Place place = columns.place();
    if (place.candidate->name() != simpler) continue;
    const std::vector<FoundEffect> with_map = s.effects;
    const auto isMap = [&](const FoundEffect& e) { return e.hypothesis.place == found; };
    const auto own = std::find_if(with_map.begin(), with_map.end(), isMap);
    if (own == with_map.end()) return;
    if (predictsAlone(s, *own, columns, isMap)) {
      s.effects.back().indistinguishable_from.clear();
      s.taken_out.push_back(placeText(found) + ": " + placeText(place) + " explains as much");
    } else {
      s.effects = with_map;
    }
    refit(s);
  }
}

}  // namespace knee_robot::tracing
