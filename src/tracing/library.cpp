#include "library.h"

#include "knee_robot/base/parallel.h"

namespace knee_robot::tracing {

void Library::add(const CandidateList& candidates, const TraceData& data, bool fast_only) {
  const std::size_t first = places_.size();
  for (std::vector<Hypothesis>& tried : byPlace(listHypotheses(candidates, data.inputs))) {
    if (fast_only && !tried.front().place.candidate->actsFast()) continue;
    PlaceColumns place;
    place.rests_on_model = tried.front().place.candidate->restsOnModel();
    place.tried = std::move(tried);
    places_.push_back(std::move(place));
  }
  inParallel(places_.size() - first, [&](std::size_t k) {
    PlaceColumns& place = places_[first + k];
    place.rows = placeRows(data, place.tried, place.first_row);
  });
}

void Library::update(const TraceData& data, bool friction_changed) {
  inParallel(places_.size(), [&](std::size_t k) {
    PlaceColumns& place = places_[k];
    if (friction_changed || place.rests_on_model) place.rows = placeRows(data, place.tried, place.first_row);
  });
}

}  // namespace knee_robot::tracing
