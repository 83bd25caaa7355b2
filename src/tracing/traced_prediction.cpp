#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {

Eigen::MatrixXd predictTraced(const mechanism::Robot& robot, const TraceResult& result, identification::Observation& o,
                              int recording, int recordings) {
  if (recording < 0 && result.elsewhere) return predictTraced(robot, *result.elsewhere, o, recording, recordings);
  setFriction(o, result.base.columns, result.base.memory);
  EffectInput input = effectInput(robot, o, result.base.memory, recording, recordings);
  Eigen::MatrixXd effects_N = Eigen::MatrixXd::Zero(o.samples(), o.axes());
  for (int pass = 0; pass < 2; ++pass) {  // some effects look at the whole force, which contains them
    setForces(input, result.base.columns, result.seen_parameters, effects_N);
    effects_N.setZero();
    for (const FoundEffect& e : result.effects) {
      const Eigen::VectorXd coefficients =
          recording < 0 ? e.hypothesis.place.candidate->elsewhere(e.coefficients) : e.coefficients;
      if (coefficients.size() == 0 || (recording < 0 && !e.transfers)) continue;
      for (int i = 0; i < o.axes(); ++i)
        effects_N.col(i) += effectColumns(input, e.hypothesis, i) * coefficients;
    }
  }
  setForces(input, result.base.columns, result.parameters, effects_N);
  return input.force_N;
}

Eigen::MatrixXd predictBaseline(const TraceResult& result, identification::Observation& o) {
  setFriction(o, result.baseline.columns, result.baseline.memory);
  Eigen::MatrixXd out(o.samples(), o.axes());
  for (int i = 0; i < o.axes(); ++i)
    out.col(i) = o.regressor[static_cast<std::size_t>(i)] * result.baseline.parameters;
  return out;
}

}  // namespace knee_robot::tracing
