#include "fit_feedforward.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "knee_robot/dynamics/effect_law.h"
#include "refit.h"
#include "settle_laws.h"

namespace knee_robot::tracing {
namespace {

bool hasLaw(const FoundEffect& e) {
  const Place& place = e.hypothesis.place;
  return dynamics::effectLaw(place.candidate->name(), place.candidate->dependsOn(place.actuator), e.hypothesis.shape) !=
         nullptr;
}

bool isMissed(const FoundEffect& e) {
  return !hasLaw(e) && dynamics::actsOnWithoutLaw(e.hypothesis.place.candidate->name());
}

/// Takes what is missed, and what is predicted nowhere else, out of the search.
void leaveOutMissed(Search& s) {
  const auto goes = [](const FoundEffect& e) {
    return isMissed(e) || !(e.transfers || e.hypothesis.place.candidate->local());
  };
  s.effects.erase(std::remove_if(s.effects.begin(), s.effects.end(), goes), s.effects.end());
}

}  // namespace

void fitFeedforward(Search& s, TraceResult& result, bool given) {
  if (s.data->inputs.front().robot->chain) return;
  const TraceResult& there = result.elsewhere ? *result.elsewhere : result;
  if (std::none_of(there.effects.begin(), there.effects.end(), isMissed)) return;
  TraceResult fit = result;
  fit.effects.clear();
  fit.parameters = fit.seen_parameters = result.baseline.parameters;
  fit.base.friction_laws = result.baseline.friction_laws;
  const std::vector<FoundEffect> all = s.effects;
  const BaseFit own = *s.base;
  leaveOutMissed(s);
  if (!s.effects.empty() || given) {
    refit(s);
    rebase(s);
    settleLaws(s, result.baseline);
    std::copy_if(s.effects.begin(), s.effects.end(), std::back_inserter(fit.effects),
                 [](const FoundEffect& e) { return e.transfers && hasLaw(e); });
    fit.parameters = s.base->parametersOf(s.fit.base);
    fit.seen_parameters = s.seen_parameters;
    fit.base.friction_laws = s.base->friction_laws;
  }
  s.effects = all;
  refit(s);
  adoptBase(s, own);
  result.feedforward = std::make_shared<const TraceResult>(std::move(fit));
  result.notes.push_back("A controller cannot feed forward all of it: model.yaml has numbers of their own for it.");
}

}  // namespace knee_robot::tracing
