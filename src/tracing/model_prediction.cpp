#include "knee_robot/tracing/model_prediction.h"

#include <algorithm>

#include "effects/common/warm_up.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/warming.h"
#include "knee_robot/identification/prediction.h"
#include "model_effects.h"

namespace knee_robot::tracing {
namespace {

constexpr const char* kUnnamed = "unnamed";

/// `knots`: of a map.
const Candidate* candidateOf(const mechanism::Robot& robot, const dynamics::ModelEffect& effect, int actuator,
                             const std::vector<double>& knots, const CandidateList& named, CandidateList& maps) {
  if (effect.name == kUnnamed) {
    std::unique_ptr<Candidate> map = mapCandidate(robot, effect.depends_on, actuator, knots);
    if (!map) return nullptr;
    maps.push_back(std::move(map));
    return maps.back().get();
  }
  const Candidate* other = nullptr;  // named alike, but on one actuator where the file has all, or the reverse
  for (const auto& candidate : named) {
    if (candidate->name() != effect.name) continue;
    if (candidate->shared() == (effect.actuators.size() > 1)) return candidate.get();
    other = candidate.get();
  }
  return other;
}

/// A shape with what older files lack.
std::vector<dynamics::EffectParameter> completed(std::vector<dynamics::EffectParameter> shape,
                                                 const Candidate& candidate) {
  const std::vector<ShapeParameter> asked = candidate.shapeParameters();
  for (std::size_t k = 0; k < asked.size() && k <= shape.size(); ++k) {
    const bool lacking = k == shape.size() || shape[k].name != asked[k].name;
    if (lacking && asked[k].in_older_files)
      shape.insert(shape.begin() + static_cast<std::ptrdiff_t>(k), {asked[k].name, *asked[k].in_older_files});
  }
  return shape;
}

template <typename Expected>
void requireNames(const std::vector<knee_robot::dynamics::EffectParameter>& have, const std::vector<Expected>& expected,
                  const std::string& effect, const std::string& model_path) {
  if (have.size() != expected.size()) {
    throw InputError(model_path + ": effect " + effect + " has " + std::to_string(have.size()) + " numbers where " +
                     std::to_string(expected.size()) + " belong; trace again");
  }
  for (std::size_t k = 0; k < have.size(); ++k) {
    if (have[k].name != expected[k].name) {
      throw InputError(model_path + ": effect " + effect + " has the number " + have[k].name + " where " +
                       expected[k].name + " belongs; trace again");
    }
  }
}

}  // namespace

Eigen::VectorXd inColumns(const dynamics::Model& model, const std::vector<double>& values,
                          const std::vector<identification::Column>& columns) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t k = 0; k < model.parameters.size(); ++k) {
      if (model.parameters[k].name == columns[c].name) out[static_cast<Eigen::Index>(c)] = values[k];
    }
  }
  return out;
}

void requireHeat(const std::vector<double>& shape, const WarmUp& kind, double last, const std::string& effect) {
  const double heat = shape[WarmUp::kHeatedBy];
  if (!dynamics::heatOf(heat) || heat > last) {
    throw InputError(effect + " has " + heatedByParameter().name + " " + shortNumber(heat, 4) +
                     ", which is none of 0 (the clock), 1 (motion), 2 (work), 3 (worked)" +
                     (kind.usualForce() >= 0 ? " and 4 (the windings)" : "") + "; trace again");
  }
  if (heat == dynamics::numberOf(dynamics::Heat::Winding) &&
      !(shape[static_cast<std::size_t>(kind.usualForce())] > 0.0))
    throw InputError(effect + " is heated by the windings (4), and its usual_force_N is not positive; trace again");
}

std::vector<double> shapeOf(const dynamics::ModelEffect& m, const Candidate& candidate, const std::string& model_path) {
  const std::string effect = model_path + ": effect " + m.name;
  const std::vector<ShapeParameter> asked = candidate.shapeParameters();
  const std::vector<dynamics::EffectParameter> given = completed(m.shape, candidate);
  requireNames(given, asked, m.name, model_path);
  std::vector<double> shape;
  for (const dynamics::EffectParameter& p : given) {
    const double low = asked[shape.size()].low;
    if ((low > 0.0 && !(p.value > 0.0)) || (low == 0.0 && !(p.value >= 0.0))) {
      throw InputError(
          effect + " has " + p.name + " " + shortNumber(p.value, 4) +
          (low > 0.0 ? ", which must be positive; trace again" : ", which must not be negative; trace again"));
    }
    shape.push_back(p.value);
  }
  if (const auto* kind = dynamic_cast<const WarmUp*>(&candidate))
    requireHeat(shape, *kind, asked[WarmUp::kHeatedBy].high, effect);
  return shape;
}

FoundEffect effectOf(const mechanism::Robot& robot, const dynamics::ModelEffect& m, int recordings,
                     const std::string& model_path, const CandidateList& named, CandidateList& maps) {
  FoundEffect e;
  std::vector<double> knots;
  for (const dynamics::EffectParameter& p : m.shape)
    knots.push_back(p.value);
  const int actuator = m.actuators.size() == 1 ? m.actuators.front() - 1 : -1;
  const Candidate* candidate = candidateOf(robot, m, std::max(0, actuator), knots, named, maps);
  if (candidate == nullptr) {
    throw InputError(model_path + ": effect " + m.name +
                     (m.depends_on.empty() ? "" : " that depends on " + m.depends_on) +
                     " is not known for this robot; trace again with this version");
  }
  if (!candidate->shared() && m.actuators.size() != 1)
    throw InputError(model_path + ": effect " + m.name + " must sit on one actuator; write one entry for each");
  EffectInput input;
  input.recordings = recordings;
  e.hypothesis.shape = shapeOf(m, *candidate, model_path);
  std::vector<dynamics::EffectParameter> coefficients = m.coefficients;
  const std::vector<Coefficient> asked = candidate->coefficients(input);
  if (candidate->goesWithTime() && !candidate->isMap() &&
      coefficients.size() == 2) {  // of a file before recordings began with a warmth of their own
    for (std::size_t k = 2; k < asked.size(); ++k)
      coefficients.push_back({asked[k].name, 0.0, 0.0});
  }
  requireNames(coefficients, asked, m.name, model_path);
  e.hypothesis.place = {candidate, candidate->shared() ? -1 : actuator};
  e.coefficients.resize(static_cast<Eigen::Index>(coefficients.size()));
  e.std = e.coefficients;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    e.coefficients[static_cast<Eigen::Index>(k)] = coefficients[k].value;
    e.std[static_cast<Eigen::Index>(k)] = coefficients[k].std;
  }
  e.transfers = m.transfers;
  return e;
}

void addEffect(std::vector<FoundEffect>& effects, FoundEffect effect) {
  Place& place = effect.hypothesis.place;
  for (const FoundEffect& other : effects)
    if (other.hypothesis.place == place) ++place.order;
  effects.push_back(std::move(effect));
}

identification::ObservationOptions observationOptions(const dynamics::Model& model) {
  identification::ObservationOptions options;
  options.setCutoff(model.cutoff_hz, model.fit_motion_cutoff_hz);
  options.taut_steps = model.fit_taut_steps;
  options.moving_m_per_s = model.moving_m_per_s;
  return options;
}

TraceResult resultOf(const mechanism::Robot& robot, const dynamics::Model& model, const std::string& model_path) {
  dynamics::requireModelOf(model, model_path, robot);
  if (model.effects_see.empty()) {
    throw InputError(model_path + ": lacks effects_see, without which its effects cannot be " +
                     "computed; trace again with this version");
  }
  TraceResult r;
  r.base.columns = identification::columnsOf(robot);
  r.base.friction_laws = model.friction;
  r.base.trained_force_N = model.trained_force_N;
  for (const dynamics::ModelData& data : model.data)
    r.home_ids.push_back(data.home_id);
  r.candidates = std::make_shared<CandidateList>(namedCandidates(robot));
  CandidateList maps;
  const int recordings = static_cast<int>(model.data.size());
  const auto fill = [&](TraceResult& to, const std::vector<double>& parameters, const std::vector<double>& see,
                        const std::vector<dynamics::ModelEffect>& effects) {
    to.parameters = inColumns(model, parameters, r.base.columns);
    to.seen_parameters = inColumns(model, see, r.base.columns);
    for (const dynamics::ModelEffect& m : effects)
      addEffect(to.effects, effectOf(robot, m, recordings, model_path, *r.candidates, maps));
  };
  if (model.elsewhere) {
    TraceResult other = r;
    fill(other, model.elsewhere->parameters, model.elsewhere->effects_see, model.elsewhere->effects);
    r.elsewhere = std::make_shared<const TraceResult>(std::move(other));
  }
  std::vector<double> values;
  for (const dynamics::ModelParameter& p : model.parameters)
    values.push_back(p.value);
  fill(r, values, model.effects_see, model.effects);
  for (auto& map : maps)
    r.candidates->push_back(std::move(map));
  r.base.parameters = r.parameters;
  r.base.start = Eigen::VectorXd::Zero(r.parameters.size());
  return r;
}

Eigen::MatrixXd predictModel(const mechanism::Robot& robot, const dynamics::Model& model, const std::string& model_path,
                             identification::Observation& o) {
  if (model.effects_see.empty() && model.effects.empty()) {
    dynamics::requireModelOf(model, model_path, robot);
    return identification::predictForce(model, robot, o.signals, o.motion);
  }
  const TraceResult result = resultOf(robot, model, model_path);
  const auto listed = std::find_if(model.data.begin(), model.data.end(),
                                   [&](const dynamics::ModelData& data) { return data.fingerprint == o.fingerprint; });
  const int recording = listed == model.data.end() ? -1 : static_cast<int>(listed - model.data.begin());
  return predictTraced(robot, result, o, recording, static_cast<int>(model.data.size()));
}

}  // namespace knee_robot::tracing
