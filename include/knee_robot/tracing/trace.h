#pragma once

#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/tracing/trace_result.h"

namespace knee_robot::tracing {

/// Traces the residual of the training recordings. `recordings` and `training` belong together, in order.
TraceResult trace(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                  std::vector<identification::Observation> training, const TraceOptions& options);

/// The extended model as a file holds it.
dynamics::Model tracedModel(const mechanism::Robot& robot, const TraceResult& result,
                            const std::vector<identification::Observation>& training, const TraceOptions& options);

/// Its baseline as a model file of identify would have it.
dynamics::Model baselineModel(const mechanism::Robot& robot, const TraceResult& result,
                              const std::vector<identification::Observation>& training, const TraceOptions& options);

/// Force (N, samples x actuators) that a traced model predicts along a recording, from motion and time alone.
/// `recording`: index among the training recordings, -1 for others; there effects that do not transfer are left out.
Eigen::MatrixXd predictTraced(const mechanism::Robot& robot, const TraceResult& result,
                              identification::Observation& observation, int recording, int recordings);
/// The same of the baseline alone.
Eigen::MatrixXd predictBaseline(const TraceResult& result, identification::Observation& observation);

}  // namespace knee_robot::tracing
