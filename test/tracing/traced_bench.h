#pragma once

#include <memory>

#include "knee_robot/identification/accuracy.h"
#include "knee_robot/tracing/model_prediction.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {

/// Two bench axes.
inline mechanism::Robot bench() {
  return identification::syntheticBench(2);
}

struct TracedBench {
  TraceResult result;
  dynamics::Model model;  ///< written as a model file and read again
};

/// A recording of the bench, traced as `trace` does it, from the model `start` where there is one.
inline TracedBench tracedBench(const recording::Recording& recording, const dynamics::Model* start) {
  TraceOptions options;
  options.surrogates = 3;
  if (start != nullptr) options.start = std::make_shared<const StartModel>(StartModel{*start, "given.yaml"});
  const std::vector<identification::Observation> training = {
      identification::observe(bench(), identification::columnsOf(bench()), recording, options.observation)};
  TracedBench traced;
  traced.result = trace(bench(), {recording}, training, options);
  traced.model =
      dynamics::parseModel(dynamics::modelToYaml(tracedModel(bench(), traced.result, training, options)), "given.yaml");
  return traced;
}

}  // namespace knee_robot::tracing
