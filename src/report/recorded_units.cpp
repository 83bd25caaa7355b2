#include "knee_robot/report/recorded_units.h"

#include <algorithm>
#include <set>

#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/joint_units.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {
namespace {

RecordedUnits unitsOf(const mechanism::Robot& robot) {
  RecordedUnits units;
  if (robot.kind != mechanism::MechanismKind::Chain) return units;
  for (const mechanism::Actuator& a : robot.actuators) {
    units.force.push_back(mechanism::forceUnit(a));
    units.revolute.push_back(a.revolute);
    units.joints.push_back(a.name);
  }
  return units;
}

/// Multiplies per-actuator numbers, rows or columns with what one newton is in the recorded unit.
class Converter {
 public:
  explicit Converter(const mechanism::Robot& robot) : force_(robot.axes()), position_(robot.axes()) {
    for (int i = 0; i < robot.axes(); ++i) {
      force_[i] = robot.actuators[static_cast<std::size_t>(i)].force_per_N();
      position_[i] = robot.actuators[static_cast<std::size_t>(i)].position_per_m();
    }
  }

  void forces(Eigen::VectorXd& v) const {  // one entry an actuator, or two lists after each other
    for (Eigen::Index i = 0; i < v.size(); ++i)
      v[i] *= force_[i % force_.size()];
  }
  void forces(Eigen::MatrixXd& m) const {
    if (m.cols() == force_.size()) m *= force_.asDiagonal();
  }
  void forces(std::vector<Eigen::VectorXd>& list) const {
    for (Eigen::VectorXd& v : list)
      forces(v);
  }
  void observations(std::vector<identification::Observation>& list) const {
    for (identification::Observation& o : list) {
      forces(o.row_force_N);
      forces(o.force_filtered_N);
      forces(o.signals.force_N);
      for (Eigen::MatrixXd* m : {&o.signals.position_m, &o.signals.velocity_m_per_s, &o.signals.acceleration_m_per_s2})
        *m *= position_.asDiagonal();
    }
  }
  void applied(identification::Applied& a) const {
    for (identification::Prediction& p : a.predictions) {
      forces(p.force_N);
      forces(p.force_filtered_N);
      forces(p.row_force_N);
    }
    for (Eigen::VectorXd* v : {&a.accuracy.rms_N, &a.accuracy.rms_moving_N, &a.accuracy.rms_resting_N,
                               &a.accuracy.rms_since_moved_N, &a.accuracy.rms_raw_N, &a.accuracy.max_N})
      forces(*v);
  }

 private:
  Eigen::VectorXd force_, position_;
};

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// Beginning of the list of numbers ("1, 2.5, 3") that ends before `end`.
std::size_t numbersBefore(const std::string& text, std::size_t end) {
  const auto belongs = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e'; };
  std::size_t at = end;
  while (at > 0) {
    if (belongs(text[at - 1])) {
      --at;
    } else if (at > 2 && text[at - 1] == ' ' && text[at - 2] == ',' && belongs(text[at - 3])) {
      at -= 2;
    } else {
      break;
    }
  }
  return at;
}

/// "1.5 mm/s" -> "15 mrad/s", wherever numbers stand before the unit.
void scaleNumbers(std::string& text, const std::string& unit, const std::string& to, double factor) {
  for (std::size_t at = text.find(" " + unit); at != std::string::npos; at = text.find(" " + unit, at + 1)) {
    const std::size_t after = at + 1 + unit.size();
    if (after < text.size() && (std::isalpha(static_cast<unsigned char>(text[after])) || text[after] == '/')) continue;
    const std::size_t from = numbersBefore(text, at);
    if (from == at) continue;
    std::string numbers;
    std::string list = text.substr(from, at - from) + ",";
    for (std::size_t k = 0, comma = list.find(','); comma != std::string::npos;
         k = comma + 1, comma = list.find(',', k)) {
      const std::string word = list.substr(k, comma - k);
      const std::optional<double> value = parseFinite(word.substr(std::min(word.find_first_not_of(' '), word.size())));
      if (!value) return;
      numbers += (numbers.empty() ? "" : ", ") + shortNumber(factor * *value, 4);
    }
    text.replace(from, after - from, numbers + " " + to);
  }
}

Json translated(const RecordedUnits& units, const Json& json);

/// Keys whose text, or list of texts, is sentences; "signal_path" has such lists by file.
bool isSentence(const std::string& key) {
  static const std::set<std::string> keys = {"in_words",   "sentence",           "outcome",  "verdict", "rule",
                                             "why",        "noise_floor_source", "absorbed", "notes",   "not_added",
                                             "signal_path"};
  return keys.count(key) > 0;
}

/// All texts of a value, as withUnits has them.
Json inWords(const RecordedUnits& units, Json value) {
  if (value.is_string()) {
    std::string text = withUnits(units, value.get<std::string>() + "\n");
    text.pop_back();
    return text;
  }
  for (Json& entry : value)
    if (entry.is_structured() || entry.is_string()) entry = inWords(units, entry);
  return value;
}

/// Key and value of one entry of an object.
void translateEntry(const RecordedUnits& units, const std::string& key, const Json& value, Json& out) {
  const bool ends = key.size() > 2 && key.compare(key.size() - 2, 2, "_N") == 0;
  if (ends && (value.is_array() || value.is_null())) {
    const std::string unit = units.commonForce();
    out[key.substr(0, key.size() - 2) + (unit.empty() ? "" : "_" + unit)] = value;
    return;
  }
  if (isSentence(key)) {
    out[key] = inWords(units, value);
    return;
  }
  if (key == "masks") {
    for (const auto& [file, reasons] : value.items()) {
      for (const auto& [reason, share] : reasons.items())
        out[key][file][inWords(units, reason).get<std::string>()] = share;
    }
    return;
  }
  if (value.is_number() && units.allRevolute()) {
    const dynamics::JointNumber number = dynamics::inJointUnits(key, true);
    out[number.name] = number.name == key ? value : Json(value.get<double>() * number.factor);
    return;
  }
  out[key] = translated(units, value);
}

Json translated(const RecordedUnits& units, const Json& json) {
  if (json.is_array()) {
    Json out = Json::array();
    for (const Json& entry : json)
      out.push_back(translated(units, entry));
    return out;
  }
  if (!json.is_object()) return json;
  Json out = Json::object();
  for (const auto& [key, value] : json.items()) {
    if (key == "effects" || key == "parameters" || key == "payload" || key == "links" || key == "reproduce") {
      out[key] = value;  // in the joints' units, or in kg and m, already
      if (key == "effects") {
        out[key] = Json::array();
        for (const Json& effect : value) {
          Json e = Json::object();
          for (const auto& [name, part] : effect.items()) {
            if (name == "parameters") {
              e[name] = part;
            } else {
              translateEntry(units, name, part, e);
            }
          }
          out[key].push_back(e);
        }
      }
      continue;
    }
    translateEntry(units, key, value, out);
  }
  return out;
}

}  // namespace

std::string RecordedUnits::commonForce() const {
  const bool same = !force.empty() && std::all_of(force.begin(), force.end(),
                                                  [&](const std::string& unit) { return unit == force.front(); });
  return same ? force.front() : "";
}

bool RecordedUnits::allRevolute() const {
  return !revolute.empty() && std::all_of(revolute.begin(), revolute.end(), [](char r) { return r != 0; });
}

void toRecordedUnits(const mechanism::Robot& robot, IdentifyResults& r) {
  r.units = unitsOf(robot);
  if (r.units.plain()) return;
  const Converter convert(robot);
  for (auto* list : {&r.train, &r.validate})
    convert.observations(*list);
  for (identification::Applied* a : {&r.train_before, &r.train_after, &r.validate_before, &r.validate_after,
                                     &r.train_physical, &r.validate_physical})
    convert.applied(*a);
  convert.forces(r.train_by_strength);
  convert.forces(r.validate_by_strength);
  for (identification::Identification* id : {&r.before, &r.after}) {
    convert.forces(id->noise_N);
    id->model = dynamics::inJointUnits(id->model);
  }
  if (r.physical) r.physical->model = dynamics::inJointUnits(r.physical->model);
}

void toRecordedUnits(const mechanism::Robot& robot, TraceResults& r) {
  r.units = unitsOf(robot);
  if (r.units.plain()) return;
  const Converter convert(robot);
  for (auto* list : {&r.train, &r.validate})
    convert.observations(*list);
  for (identification::Applied* a : {&r.train_before, &r.train_after, &r.validate_before, &r.validate_after})
    convert.applied(*a);
  convert.forces(r.validate_gain_N);
  for (Eigen::VectorXd* v : {&r.result.floor_N, &r.result.before_rms_N, &r.result.after_rms_N})
    convert.forces(*v);
  for (tracing::FoundEffect& e : r.result.effects) {
    convert.forces(e.explained_rms_N);
    convert.forces(e.null_rms_N);
  }
  r.model = dynamics::inJointUnits(r.model);
}

void toRecordedUnits(const mechanism::Robot& robot, PredictResults& r) {
  r.units = unitsOf(robot);
  if (r.units.plain()) return;
  const Converter convert(robot);
  convert.observations(r.observations);
  convert.applied(r.applied);
}

std::string withUnits(const RecordedUnits& units, std::string text) {
  if (units.plain()) return text;
  std::string force = units.commonForce();
  if (force == "Nm") force = "N m";
  if (force.empty()) force = "N or N m";
  for (const char* end : {"\n", ")", ";", ". ", ".\n", ", p", " rms", " ->"}) {
    replaceAll(text, std::string(", N") + end, ", " + force + end);
    replaceAll(text, std::string(" N") + end, " " + force + end);
  }
  replaceAll(text, "ctuator ", "ctuator\x01");
  replaceAll(text, "Actuator\x01", "Joint ");
  replaceAll(text, "actuator\x01", "joint ");
  if (!units.allRevolute()) return text;
  for (const char* end : {")", "_times_"}) {  // signals that a map depends on
    replaceAll(text, std::string("_m_per_s") + end, std::string("_rad_per_s") + end);
    replaceAll(text, std::string("_m") + end, std::string("_rad") + end);
    replaceAll(text, std::string("_N") + end, std::string("_Nm") + end);
  }
  constexpr double kPerMetre = 1.0 / mechanism::kJointRadius_m;
  scaleNumbers(text, "mm/s", "mrad/s", kPerMetre);
  scaleNumbers(text, "mm", "mrad", kPerMetre);
  scaleNumbers(text, "um", "urad", kPerMetre);
  return text;
}

std::string jsonWithUnits(const RecordedUnits& units, const std::string& text) {
  if (units.plain()) return text;
  Json out = translated(units, Json::parse(text));
  out["units"] = units.force;
  out["joints"] = units.joints;
  out["position_units"] = Json::array();
  for (const char revolute : units.revolute)
    out["position_units"].push_back(revolute ? "rad" : "m");
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace knee_robot::report
