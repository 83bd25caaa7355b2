#include "knee_robot/identification/trained_range.h"
#include "knee_robot/tracing/trace.h"
#include "null.h"

namespace knee_robot::tracing {
namespace {

/// Training recordings of the same homing.
std::vector<int> sameHome(const std::vector<std::int64_t>& home_ids, std::int64_t home_id) {
  std::vector<int> same;
  for (std::size_t r = 0; home_id != 0 && r < home_ids.size(); ++r) {
    if (home_ids[r] == home_id) same.push_back(static_cast<int>(r));
  }
  return same;
}

/// Coefficients on a recording that is none of training; empty: it predicts nothing there.
Eigen::VectorXd coefficientsElsewhere(const FoundEffect& e, const std::vector<int>& same_home) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  if (candidate.transfers() && !e.transfers) return {};
  return same_home.empty() ? candidate.elsewhere(e.coefficients) : candidate.atHome(e.coefficients, same_home);
}

}  // namespace

Eigen::MatrixXd predictTraced(const mechanism::Robot& robot, const TraceResult& result, identification::Observation& o,
                              int recording, int recordings) {
  if (recording < 0 && result.elsewhere) return predictTraced(robot, *result.elsewhere, o, recording, recordings);
  setFriction(o, result.base.columns, result.base.friction_laws);
  const std::vector<int> same_home = sameHome(result.home_ids, o.home_id);
  EffectInput input = effectInput(robot, o, result.base.friction_laws, recording, recordings);
  SurrogateModel acting;
  for (const FoundEffect& e : result.effects) {
    const Eigen::VectorXd coefficients = recording < 0 ? coefficientsElsewhere(e, same_home) : e.coefficients;
    if (coefficients.size() == 0) continue;
    acting.effects.push_back(e.hypothesis);
    acting.coefficients.push_back(coefficients);
  }
  lookAhead(input, acting);
  const SurrogateEffects forces = settleForces(input, result.base.columns, result.seen_parameters, acting);
  setModel(input, result.base.columns, result.parameters);
  setEffects(input, forces.friction_N + forces.load_N);
  identification::keepWithinTrainedRange(result.base.trained_force_N, o.motion, input.force_N);
  return input.force_N;
}

Eigen::MatrixXd predictBaseline(const TraceResult& result, identification::Observation& o) {
  setFriction(o, result.baseline.columns, result.baseline.friction_laws);
  Eigen::MatrixXd out(o.samples(), o.axes());
  for (int i = 0; i < o.axes(); ++i)
    out.col(i) = o.regressor[static_cast<std::size_t>(i)] * result.baseline.parameters;
  identification::keepWithinTrainedRange(result.baseline.trained_force_N, o.motion, out);
  return out;
}

}  // namespace knee_robot::tracing
