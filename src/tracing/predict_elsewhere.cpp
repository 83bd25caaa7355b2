#include "predict_elsewhere.h"

#include <algorithm>

#include "abstain.h"
#include "elsewhere.h"
#include "one_path.h"
#include "refit.h"

namespace knee_robot::tracing {
namespace {

/// Friction that was fitted beside an effect is wrong without it: the effects that transfer are fitted anew.
TraceResult withWhatTransfers(const mechanism::Robot& robot, Search& s, TraceResult& result) {
  ElsewhereFit fit = fitElsewhere(s, result.baseline, s.options->start || robot.chain);
  keepFit(s, result);
  TraceResult elsewhere = result;
  elsewhere.effects = std::move(fit.effects);
  elsewhere.parameters = fit.parameters;
  elsewhere.seen_parameters = fit.seen_parameters;
  return elsewhere;
}

TraceResult withBaselineAlone(Search& s, bool described, TraceResult& result) {
  result.notes.push_back(
      std::string(described ? "In held-back parts of the training recordings nothing that was found is surely better "
                              "than the baseline: "
                            : "The baseline does not describe the one path that was seen: ") +
      "elsewhere the baseline is predicted.");
  adoptBase(s, result.baseline);  // a model has one law near rest: that of what is predicted elsewhere
  keepFit(s, result);
  TraceResult elsewhere = result;
  elsewhere.effects.clear();
  elsewhere.parameters = elsewhere.seen_parameters = result.baseline.parameters;
  return elsewhere;
}

}  // namespace

void keepFit(Search& s, TraceResult& result) {
  result.effects = s.effects;
  const bool untouched = s.effects.empty() && !s.options->start;
  if (untouched) adoptBase(s, result.baseline);  // what was taken out again may have left another law behind
  result.parameters = untouched ? result.baseline.parameters : result.base.parametersOf(s.fit.base);
  result.seen_parameters = s.seen_parameters;
  result.after_rms_N = s.rms_N;
  result.floor_N = s.floor.rms_N;  // beside what was found: effects in surrogates of the baseline are none
  result.floor_source = s.floor.source;
}

void predictElsewhere(const mechanism::Robot& robot, Search& s, TraceResult& result) {
  if (s.effects.empty()) return;
  const bool described = !isOnePathNotDescribed(result.doubts, s.data->recordings);
  const bool helps = s.options->start || robot.chain || (described && helpsElsewhere(s, result.baseline));
  if (!robot.chain && leaveOutSmall(s, helps, result.rejected) > 0) {
    if (helps) {
      refit(s);
    } else if (s.effects.empty()) {
      adoptBase(s, result.baseline);
    }
    if (helps || s.effects.empty()) keepFit(s, result);
    if (s.effects.empty()) return;
  }
  const auto transfers = [&](const FoundEffect& e) { return helps && e.transfers; };
  if (std::all_of(s.effects.begin(), s.effects.end(), transfers)) return;
  TraceResult elsewhere = helps ? withWhatTransfers(robot, s, result) : withBaselineAlone(s, described, result);
  result.elsewhere = std::make_shared<const TraceResult>(std::move(elsewhere));
}

}  // namespace knee_robot::tracing
