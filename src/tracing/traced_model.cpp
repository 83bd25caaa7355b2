#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {
namespace {

dynamics::ModelEffect modelEffect(const FoundEffect& e, const EffectInput& input, int axes) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  const int actuator = e.hypothesis.place.actuator;
  dynamics::ModelEffect m;
  m.name = candidate.name();
  m.depends_on = candidate.dependsOn(actuator);
  m.transfers = e.transfers && candidate.elsewhere(e.coefficients).size() > 0;
  for (int i = 0; i < axes; ++i) {
    if (actuator < 0 || actuator == i) m.actuators.push_back(i + 1);
  }
  const std::vector<ShapeParameter> shapes = candidate.shapeParameters();
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    dynamics::EffectParameter p;
    p.name = shapes[k].name;
    p.value = e.hypothesis.shape[k];
    m.shape.push_back(p);
  }
  const std::vector<Coefficient> coefficients = candidate.coefficients(input);
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    m.coefficients.push_back({coefficients[k].name, e.coefficients[at], e.std[at]});
  }
  return m;
}

std::vector<double> valuesOf(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

}  // namespace

dynamics::Model tracedModel(const mechanism::Robot& robot, const TraceResult& result,
                            const std::vector<identification::Observation>& training, const TraceOptions& options) {
  dynamics::Model m;
  m.kind = robot.kind;
  m.axes = robot.axes();
  m.joints = dynamics::modelJoints(robot);
  m.robot_fingerprint = robot.fingerprint;
  for (const identification::Observation& o : training)
    m.data.push_back({o.path, o.fingerprint, o.home_id});
  m.cutoff_hz = options.observation.cutoff_hz;
  m.fit_taut_steps = options.observation.taut_steps;
  if (options.observation.motion_cutoff_given) m.fit_motion_cutoff_hz = options.observation.signals.motion_cutoff_hz;
  m.moving_m_per_s = options.observation.moving_m_per_s;
  m.rank = result.base.decided;
  m.friction = result.base.friction_laws;
  m.effects_see = valuesOf(result.seen_parameters);
  m.residual_rms_N.assign(result.after_rms_N.data(), result.after_rms_N.data() + result.after_rms_N.size());
  m.trained_force_N = result.base.trained_force_N;
  for (std::size_t c = 0; c < result.base.columns.size(); ++c) {
    dynamics::ModelParameter p;
    p.name = result.base.columns[c].name;
    p.unit = result.base.columns[c].unit;
    p.value = result.parameters[static_cast<Eigen::Index>(c)];
    m.parameters.push_back(p);
  }
  EffectInput input;
  input.recordings = static_cast<int>(training.size());
  for (const FoundEffect& e : result.effects)
    m.effects.push_back(modelEffect(e, input, m.axes));
  const auto numbers = [&](const TraceResult& there) {
    dynamics::ModelElsewhere n = {valuesOf(there.parameters), valuesOf(there.seen_parameters), {}};
    for (const FoundEffect& e : there.effects)
      n.effects.push_back(modelEffect(e, input, m.axes));
    return n;
  };
  if (result.elsewhere) m.elsewhere = numbers(*result.elsewhere);
  if (result.feedforward)
    m.feedforward = dynamics::ModelFeedforward{numbers(*result.feedforward), result.feedforward->base.friction_laws};
  return m;
}

dynamics::Model baselineModel(const mechanism::Robot& robot, const TraceResult& result,
                              const std::vector<identification::Observation>& training, const TraceOptions& options) {
  TraceResult plain = result;
  plain.base = result.baseline;
  plain.parameters = result.baseline.parameters;
  plain.effects.clear();
  plain.elsewhere.reset();
  plain.feedforward.reset();
  dynamics::Model model = tracedModel(robot, plain, training, options);
  model.effects_see.clear();  // of identify: predicted instant by instant
  return model;
}

}  // namespace knee_robot::tracing
