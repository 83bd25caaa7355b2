#include "replace_kin.h"

#include <algorithm>
#include <cmath>

#include "near_rest.h"
#include "refine.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

std::string kindOf(const Candidate& c) {
  return c.generalizes().empty() ? c.name() : c.generalizes();
}

/// Older ones of the same kind; not those of a given model, or of another band.
bool isKin(const FoundEffect& e, const Place& place) {
  const Place& own = e.hypothesis.place;
  return !(own == place) && own.actuator == place.actuator && kindOf(*own.candidate) == kindOf(*place.candidate) &&
         !std::isnan(e.p) && e.band_hz == 0.0;
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

/// The model with this effect in the place of it and its kin, its shape searched for anew and refined.
void putAlone(Search& s, const FoundEffect& own, const PlaceColumns& columns) {
  const Place& place = own.hypothesis.place;
  const auto goes = [&](const FoundEffect& e) { return isKin(e, place) || e.hypothesis.place == place; };
  FoundEffect alone = own;
  s.effects.erase(std::remove_if(s.effects.begin(), s.effects.end(), goes), s.effects.end());
  refit(s);
  alone.hypothesis.shape = bestOfLibrary(s, columns).shape;
  s.effects.push_back(alone);
  refit(s);
  refineShapes(s);
  s.effects.back().explained_rms_N = explainedBy(s, s.effects.size() - 1);
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
  if (!place.candidate->shared() || columns == places.end() || own == together.end() ||
      std::none_of(together.begin(), together.end(), isOld))
    return;
  const Eigen::VectorXd noise_N = s.rms_N;
  const auto heldBack = [&] {
    s.rms_N = noise_N;  // all weighted alike
    return problemOf(s, hypothesesOf(s.effects)).heldBack();
  };
  const Eigen::VectorXd with = heldBack();
  putAlone(s, *own, *columns);
  const HeldBackGain lost = heldBackGain(heldBack() - with);
  const bool plausible = s.fit.stable.back() && place.candidate->plausible(s.effects.back().coefficients);
  if (lost.mean > lost.error || !plausible) {
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

}  // namespace knee_robot::tracing
