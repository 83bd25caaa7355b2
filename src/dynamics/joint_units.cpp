#include "knee_robot/dynamics/joint_units.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "knee_robot/dynamics/model.h"

namespace knee_robot::dynamics {
namespace {

/// A word of a unit: what it becomes for a revolute joint, and the power of the radius that its number is multiplied
/// with.
struct Word {
  const char* joint;
  int power;
};

const std::map<std::string, Word>& words() {
  static const std::map<std::string, Word> all = {
      {"m", {"rad", -1}}, {"m2", {"rad2", -2}}, {"N", {"Nm", 1}},    {"kg", {"kgm2", 2}},
      {"s", {"s", 0}},    {"s2", {"s2", 0}},    {"per", {"per", 0}}, {"squared", {"squared", 0}}};
  return all;
}

std::vector<std::string> split(const std::string& name) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  while (true) {
    const std::size_t to = name.find('_', from);
    parts.push_back(name.substr(from, to - from));
    if (to == std::string::npos) return parts;
    from = to + 1;
  }
}

JointNumber translate(const std::string& whole, const std::map<std::string, Word>& dictionary) {
  const std::size_t end = std::min(whole.find("_in_recording_"), whole.size());
  const std::string name = whole.substr(0, end);
  std::vector<std::string> parts = split(name);
  std::size_t first = parts.size();  // of the words of the unit, which end the name
  while (first > 1 && dictionary.count(parts[first - 1]) > 0)
    --first;
  JointNumber out;
  int sign = 1;
  for (std::size_t k = first; k < parts.size(); ++k) {
    if (parts[k] == "per") sign = -1;
    const Word& word = dictionary.at(parts[k]);
    out.factor *= std::pow(mechanism::kJointRadius_m, sign * word.power);
    parts[k] = word.joint;
  }
  for (const std::string& part : parts)
    out.name += (out.name.empty() ? "" : "_") + part;
  out.name += whole.substr(end);
  return out;
}

using Translation = JointNumber (*)(const std::string&, bool);

/// Number behind the signal's name, "position_3_m": 3; 0 when there is none.
int numberIn(const std::string& signal) {
  for (const std::string& part : split(signal)) {
    if (!part.empty() && part.find_first_not_of("0123456789") == std::string::npos) return std::stoi(part);
  }
  return 0;
}

void translateNumbers(std::vector<EffectParameter>& numbers, bool revolute, Translation translation) {
  for (EffectParameter& p : numbers) {
    const JointNumber joint = translation(p.name, revolute);
    p.name = joint.name;
    p.value *= joint.factor;
    p.std *= joint.factor;
  }
}

/// A map's knots are values of the signal that it depends on.
void translateSignal(ModelEffect& e, const std::vector<ModelJoint>& joints, Translation translation) {
  const std::size_t end = std::min(e.depends_on.find("_times_"), e.depends_on.size());
  const int of = numberIn(e.depends_on);
  if (of < 1 || of > static_cast<int>(joints.size())) return;
  const JointNumber signal =
      translation(e.depends_on.substr(0, end), joints[static_cast<std::size_t>(of) - 1].revolute);
  e.depends_on = signal.name + e.depends_on.substr(end);
  for (EffectParameter& knot : e.shape)
    knot.value *= signal.factor;
}

Model translateEffects(Model m, Translation translation) {
  std::vector<std::vector<ModelEffect>*> lists = {&m.effects};
  if (m.elsewhere) lists.push_back(&m.elsewhere->effects);
  for (std::vector<ModelEffect>* list : lists) {
    for (ModelEffect& e : *list) {
      if (m.joints.empty() || e.actuators.size() != 1) continue;
      const bool revolute = m.joints[static_cast<std::size_t>(e.actuators.front()) - 1].revolute;
      translateNumbers(e.shape, revolute, translation);
      translateNumbers(e.coefficients, revolute, translation);
      if (!e.depends_on.empty()) translateSignal(e, m.joints, translation);
    }
  }
  return m;
}

}  // namespace

double forcePerNewton(const ModelJoint& joint) {
  const double radius = joint.revolute ? mechanism::kJointRadius_m : 1.0;
  const bool current = joint.force_unit == "A";
  return current && joint.torque_per_ampere > 0.0 ? radius / joint.torque_per_ampere : radius;
}

Model inJointUnits(Model model) {
  if (model.in_joint_units) return model;
  model.in_joint_units = true;
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    model.residual_rms_N[i] *= forcePerNewton(model.joints[i]);
  return translateEffects(std::move(model), &inJointUnits);
}

Model fromJointUnits(Model model) {
  model.in_joint_units = false;
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    model.residual_rms_N[i] /= forcePerNewton(model.joints[i]);
  return translateEffects(std::move(model), &fromJointUnits);
}

JointNumber inJointUnits(const std::string& name, bool revolute) {
  return revolute ? translate(name, words()) : JointNumber{name, 1.0};
}

JointNumber fromJointUnits(const std::string& name, bool revolute) {
  if (!revolute) return {name, 1.0};
  std::map<std::string, Word> back;
  for (const auto& [unit, word] : words())
    back[word.joint] = {unit.c_str(), -word.power};
  return translate(name, back);
}

}  // namespace knee_robot::dynamics
