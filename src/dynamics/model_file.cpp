#include <algorithm>
#include <cmath>
#include <set>

#include "friction_file.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/dynamics/model.h"

namespace knee_robot::dynamics {
namespace {

constexpr int kFirstFormat = 1;  ///< of identify: one stop per actuator
constexpr int kFormat = 3;
constexpr int kFormatOfTrace = 4;  ///< may have effects, and what predictions along recordings need
constexpr double kLargest = 1e15;
/// Says that the file has an end, which files of older versions do not.
constexpr const char* kHead =
    "# Force model of a robot, written by identify or trace. SI units. The last line is three dots.";
constexpr const char* kEnd = "...";
constexpr const char* kParallel = "3UPS+1RPU";
constexpr const char* kAxes = "axes";
constexpr const char* kChain = "chain";
constexpr int kMostJoints = 12;

std::string list(const std::vector<double>& values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += (i ? ", " : "") + exactNumber(values[i]);
  return text + "]";
}

/// A double-quoted YAML scalar.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 32 ? '?' : c;
  }
  return out + "\"";
}

std::string effectParameters(const std::vector<EffectParameter>& parameters) {
  std::string text = "[";
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const EffectParameter& p = parameters[i];
    text += (i ? ", " : "") + std::string("{name: ") + quoted(p.name) + ", value: " + exactNumber(p.value);
    if (std::isfinite(p.std)) text += ", std: " + exactNumber(p.std);
    text += "}";
  }
  return text + "]";
}

std::string effectText(const ModelEffect& e) {
  std::string y = "  - {name: " + quoted(e.name);
  if (!e.depends_on.empty()) y += ", depends_on: " + quoted(e.depends_on);
  y += ", actuators: [";
  for (std::size_t i = 0; i < e.actuators.size(); ++i)
    y += (i ? ", " : "") + std::string("{actuator: ") + std::to_string(e.actuators[i]) + "}";
  y += std::string("], transfers: ") + (e.transfers ? "yes" : "no");
  return y + ",\n     shape: " + effectParameters(e.shape) +
         ",\n     coefficients: " + effectParameters(e.coefficients) + "}\n";
}

std::string effectsText(const std::string& key, const std::vector<ModelEffect>& effects) {
  std::string y = key + (effects.empty() ? ": []\n" : ":\n");
  for (const ModelEffect& e : effects)
    y += effectText(e);
  return y;
}

bool ofTrace(const Model& m) {
  return !m.effects.empty() || !m.effects_see.empty();
}

std::string numbersText(const std::string& use, const ModelElsewhere& numbers) {
  return "parameters_" + use + ": " + list(numbers.parameters) + "\neffects_see_" + use + ": " +
         list(numbers.effects_see) + "\n" + effectsText("effects_" + use, numbers.effects);
}

/// What only trace writes.
std::string traceText(const Model& m) {
  std::string y = "# Effects beyond the parameters above; shapes bend their columns, coefficients multiply them.\n";
  y += effectsText("effects", m.effects);
  if (!m.effects_see.empty()) y += "effects_see: " + list(m.effects_see) + "\n";
  if (m.elsewhere) y += "# On recordings that are not listed under data.\n" + numbersText("elsewhere", *m.elsewhere);
  if (!m.feedforward) return y;
  y += "# In a controller: fitted without effects that it cannot give instant by instant.\n";
  return y + numbersText("feedforward", m.feedforward->numbers) +
         frictionText(m.feedforward->friction, "friction_near_rest_feedforward");
}

ModelParameter readParameter(StrictMap map) {
  ModelParameter p;
  p.name = map.text("name");
  p.unit = map.text("unit");
  p.value = map.number("value", -kLargest, kLargest);
  if (map.has("std")) p.std = map.number("std", 0.0, kLargest);
  p.verdict = map.choice("verdict", {"identified", "weakly identified", "at its bound", "not identifiable",
                                     "in units of an unknown gain"});
  map.finish();
  return p;
}

BaseParameter readBase(StrictMap map, std::size_t parameters) {
  BaseParameter b;
  b.value = map.number("value", -kLargest, kLargest);
  b.std = map.number("std", 0.0, kLargest);
  b.weights = map.numbers("weights", parameters, -kLargest, kLargest);
  map.finish();
  return b;
}

EffectParameter readEffectParameter(StrictMap map) {
  EffectParameter p;
  p.name = map.text("name");
  p.value = map.number("value", -kLargest, kLargest);
  if (map.has("std")) p.std = map.number("std", 0.0, kLargest);
  map.finish();
  return p;
}

ModelEffect readEffect(StrictMap map, int axes) {
  ModelEffect e;
  e.name = map.text("name");
  if (map.has("depends_on")) e.depends_on = map.text("depends_on");
  std::vector<StrictMap> actuators = map.maps("actuators");
  for (StrictMap& actuator : actuators) {
    e.actuators.push_back(actuator.integer("actuator", 1, axes));
    actuator.finish();
  }
  e.transfers = map.choice("transfers", {"yes", "no"}) == "yes";
  for (StrictMap& entry : map.maps("shape"))
    e.shape.push_back(readEffectParameter(entry));
  for (StrictMap& entry : map.maps("coefficients"))
    e.coefficients.push_back(readEffectParameter(entry));
  map.finish();
  return e;
}

std::vector<ModelEffect> readEffects(StrictMap& file, const std::string& key, int axes) {
  std::vector<ModelEffect> effects;
  for (StrictMap& entry : file.maps(key))
    effects.push_back(readEffect(entry, axes));
  return effects;
}

void readTrace(StrictMap& file, Model& m) {
  m.effects = readEffects(file, "effects", m.axes);
  const std::size_t parameters = m.parameters.size();
  if (file.has("effects_see")) m.effects_see = file.numbers("effects_see", parameters, -kLargest, kLargest);
  if (file.has("parameters_elsewhere")) {
    m.elsewhere.emplace();
    m.elsewhere->parameters = file.numbers("parameters_elsewhere", parameters, -kLargest, kLargest);
    m.elsewhere->effects_see = file.numbers("effects_see_elsewhere", parameters, -kLargest, kLargest);
    m.elsewhere->effects = readEffects(file, "effects_elsewhere", m.axes);
  }
  if (!file.has("parameters_feedforward") || !m.joints.empty()) return;  // a chain's model drives no controller
  ModelFeedforward& controller = m.feedforward.emplace();
  controller.numbers.parameters = file.numbers("parameters_feedforward", parameters, -kLargest, kLargest);
  controller.numbers.effects_see = file.numbers("effects_see_feedforward", parameters, -kLargest, kLargest);
  controller.numbers.effects = readEffects(file, "effects_feedforward", m.axes);
  controller.friction = readFriction(file, "friction_near_rest_feedforward", m.axes);
}

void checkNames(const Model& model, const StrictMap& file) {
  const std::vector<std::string> names = model.kind == mechanism::MechanismKind::Axes ? axisParameterNames(model.axes)
                                         : model.kind == mechanism::MechanismKind::Chain
                                             ? chainParameterNames(model.axes)
                                             : extendedParameterNames();
  std::set<std::string> allowed(names.begin(), names.end());
  for (const ModelParameter& parameter : model.parameters) {
    if (allowed.erase(parameter.name) == 0) {
      file.refuse("parameters", parameter.name + " is unknown for this mechanism, or occurs twice");
    }
  }
}

std::string jointsText(const std::vector<ModelJoint>& joints) {
  std::string y = "joints:\n";
  for (const ModelJoint& j : joints) {
    y += "  - {name: " + quoted(j.name) + ", kind: " + (j.revolute ? "revolute" : "prismatic") +
         ", force_unit: " + j.force_unit;
    if (j.torque_per_ampere > 0.0)
      y += ", torque_per_ampere_Nm: " + exactNumber(std::min(j.torque_per_ampere, kLargest));
    if (j.torque_per_ampere_std != 0.0)  // not a number: of a gain that data do not determine at all
      y += ", torque_per_ampere_std_Nm: " +
           exactNumber(j.torque_per_ampere_std < kLargest ? j.torque_per_ampere_std : kLargest);
    y += "}\n";
  }
  return y;
}

void readJoints(StrictMap& file, Model& m) {
  for (StrictMap& entry : file.maps("joints")) {
    ModelJoint joint;
    joint.name = entry.text("name");
    joint.revolute = entry.choice("kind", {"revolute", "prismatic"}) == "revolute";
    joint.force_unit = entry.choice("force_unit", {"N", "Nm", "A"});
    joint.torque_per_ampere = entry.numberOr("torque_per_ampere_Nm", 0.0, 0.0, kLargest);
    joint.torque_per_ampere_std = entry.numberOr("torque_per_ampere_std_Nm", 0.0, 0.0, kLargest);
    entry.finish();
    m.joints.push_back(joint);
  }
  if (static_cast<int>(m.joints.size()) != m.axes)
    file.refuse("joints", "has " + std::to_string(m.joints.size()) + " entries where " + std::to_string(m.axes) +
                              " axes need one each");
}

Model readModel(StrictMap file) {
  const int format = file.integer("format", kFirstFormat, kFormatOfTrace);
  if (format == 2)
    file.refuse("format", "2 was written by an older trace, whose friction is not known any more; trace again");
  Model m;
  const std::string kind = file.choice("mechanism", {kParallel, kAxes, kChain});
  m.kind = kind == kAxes    ? mechanism::MechanismKind::Axes
           : kind == kChain ? mechanism::MechanismKind::Chain
                            : mechanism::MechanismKind::ThreeUpsOneRpu;
  const bool chain = kind == kChain;
  m.axes = file.integer("axes", kind == kParallel ? mechanism::kLegs : 1, chain ? kMostJoints : mechanism::kLegs);
  if (chain) readJoints(file, m);
  std::vector<char> revolute;
  for (const ModelJoint& joint : m.joints)
    revolute.push_back(joint.revolute);
  m.robot_fingerprint = file.text("robot_fingerprint");
  for (StrictMap& entry : file.maps("data")) {
    ModelData data;
    data.file = entry.text("file");
    data.fingerprint = entry.text("fingerprint");
    if (entry.has("home_id")) data.home_id = static_cast<std::int64_t>(entry.number("home_id", -9e15, 9e15));
    entry.finish();
    m.data.push_back(data);
  }
  const std::size_t axes = static_cast<std::size_t>(m.axes);
  m.cutoff_hz = file.number("cutoff_hz", 1e-6, 1e6);
  if (file.has("motion_cutoff_hz")) m.motion_cutoff_hz = file.number("motion_cutoff_hz", 1e-6, 1e6);
  if (file.has("fit_taut_steps")) m.fit_taut_steps = file.number("fit_taut_steps", 0.0, 100.0);
  if (file.has("fit_motion_cutoff_hz")) m.fit_motion_cutoff_hz = file.number("fit_motion_cutoff_hz", 1e-6, 1e6);
  m.moving_m_per_s = file.number("moving_m_per_s", 0.0, 1e3);
  m.rank = file.integer("rank", 1, 1000);
  if (format == kFirstFormat) {
    for (const double width_m : file.numbers("coulomb_width_m", axes, 1e-12, 1e3))
      m.friction.push_back(stopLaw(width_m));
  } else {
    m.friction = readFriction(file, "friction_near_rest", m.axes, revolute);
  }
  m.residual_rms_N =
      chain ? file.numbers("residual_rms", axes, 0.0, kLargest) : file.numbers("residual_rms_N", axes, 0.0, kLargest);
  if (file.has("trained_force_N")) {
    const std::vector<double> ends = file.numbers("trained_force_N", 2 * axes, -kLargest, kLargest);
    for (std::size_t i = 0; i < axes; ++i)
      m.trained_force_N.push_back({ends[2 * i], ends[2 * i + 1]});
  }
  for (StrictMap& entry : file.maps("parameters"))
    m.parameters.push_back(readParameter(entry));
  for (StrictMap& entry : file.maps("base"))
    m.base.push_back(readBase(entry, m.parameters.size()));
  if (format == kFormatOfTrace) readTrace(file, m);
  checkNames(m, file);
  file.finish();
  return chain ? fromJointUnits(std::move(m)) : m;
}

/// Lists that have lost their last entries are lists: a copy that was interrupted is known by its missing end.
void requireEnd(const std::string& text, const std::string& path) {
  if (text.rfind(kHead, 0) != 0) return;
  const std::string end = std::string("\n") + kEnd;
  const std::size_t length = text.find_last_not_of(" \t\r\n") + 1;
  if (length >= end.size() && text.compare(length - end.size(), end.size(), end) == 0) return;
  throw InputError(path + ": its last line is not \"" + kEnd +
                   "\", so it is cut off (a full disk, an interrupted copy); copy it again, or identify again");
}

const char* kindName(mechanism::MechanismKind kind) {
  return kind == mechanism::MechanismKind::Axes ? kAxes : kind == mechanism::MechanismKind::Chain ? kChain : kParallel;
}

}  // namespace

std::string modelToYaml(const Model& model) {
  const Model m = inJointUnits(model);
  std::string y = std::string(kHead) + "\n";
  y += "format: " + std::to_string(ofTrace(m) ? kFormatOfTrace : kFormat) + "\n";
  y += std::string("mechanism: ") + kindName(m.kind) + "\n";
  y += "axes: " + std::to_string(m.axes) + "\n";
  if (!m.joints.empty()) y += jointsText(m.joints);
  y += "robot_fingerprint: " + quoted(m.robot_fingerprint) + "\n";
  y += "data:\n";
  for (const ModelData& d : m.data)
    y += "  - {file: " + quoted(d.file) + ", fingerprint: " + quoted(d.fingerprint) +
         (d.home_id != 0 ? ", home_id: " + std::to_string(d.home_id) : "") + "}\n";
  y += "cutoff_hz: " + exactNumber(m.cutoff_hz) + "\n";
  if (m.motion_cutoff_hz > 0.0) y += "motion_cutoff_hz: " + exactNumber(m.motion_cutoff_hz) + "\n";
  if (m.fit_taut_steps > 0.0) y += "fit_taut_steps: " + exactNumber(m.fit_taut_steps) + "\n";
  if (m.fit_motion_cutoff_hz > 0.0) y += "fit_motion_cutoff_hz: " + exactNumber(m.fit_motion_cutoff_hz) + "\n";
  y += "moving_m_per_s: " + exactNumber(m.moving_m_per_s) + "\n";
  y += "rank: " + std::to_string(m.rank) + "\n";
  y += frictionText(m.friction, "friction_near_rest");
  y += (m.joints.empty() ? "residual_rms_N: " : "residual_rms: ") + list(m.residual_rms_N) + "\n";
  if (!m.trained_force_N.empty()) {
    std::vector<double> ends;
    for (const TrainedForce& range : m.trained_force_N)
      ends.insert(ends.end(), {range.low_N, range.high_N});
    y += "trained_force_N: " + list(ends) + "\n";
  }
  y += "# One representative of the identified combinations; parameters without std have no value of their own.\n";
  y += "parameters:\n";
  for (const ModelParameter& p : m.parameters) {
    y += "  - {name: " + quoted(p.name) + ", unit: " + quoted(p.unit) + ", value: " + exactNumber(p.value);
    if (std::isfinite(p.std)) y += ", std: " + exactNumber(p.std);
    y += ", verdict: " + p.verdict + "}\n";
  }
  y += "# value = sum of weights * parameters, in the order above; weights in N per unit of the parameter.\n";
  y += m.base.empty() ? "base: []\n" : "base:\n";
  for (const BaseParameter& b : m.base) {
    y += "  - {value: " + exactNumber(b.value) + ", std: " + exactNumber(b.std) + ", weights: " + list(b.weights) +
         "}\n";
  }
  if (ofTrace(m)) y += traceText(m);
  return y + kEnd + "\n";
}

void saveModel(const Model& model, const std::string& path) {
  writeFileAtomically(path, modelToYaml(model));
}

Model parseModel(const std::string& text, const std::string& path) {
  Model model = readModel(StrictMap::parse(text, path));
  requireEnd(text, path);  // last: where the cut shows by itself, the sentence about it says more
  return model;
}

Model loadModel(const std::string& path) {
  return parseModel(readFile(path), path);
}

}  // namespace knee_robot::dynamics
