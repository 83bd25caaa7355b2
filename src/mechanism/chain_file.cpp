#include "chain_file.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::mechanism {
namespace {

constexpr double kUsualStep_rad = 1e-4, kUsualStep_m = 1e-5;  ///< of an encoder of which nothing is said
constexpr double kUsualRange_rad = kPi, kUsualRange_m = 1.0;
constexpr double kUsualSpeed = 1.0;         ///< rad/s or m/s
constexpr double kUsualAcceleration = 5.0;  ///< rad/s^2 or m/s^2
// A chain's effort is recorded, not commanded through a converter: a step that is far below any sensor's, and no limit.
constexpr double kForceStepPerVolt_N = 1e-3, kNoLimit_V = 1e12;

/// The joints that the file names, before the URDF has told what they are.
struct Entry {
  StrictMap map;
  NamedJoint joint;
};

std::vector<Entry> readEntries(StrictMap& file) {
  std::vector<Entry> entries;
  if (!file.has("joints")) return entries;
  for (StrictMap& map : file.maps("joints")) {
    NamedJoint joint;
    joint.name = map.text("name");
    for (const Entry& other : entries) {
      if (other.joint.name == joint.name) map.refuse("name", joint.name + " occurs twice under `joints`");
    }
    joint.locked = map.has("locked_at_rad") || map.has("locked_at_m");
    if (map.has("locked_at_rad")) joint.locked_at = map.number("locked_at_rad", -1e3, 1e3);
    if (map.has("locked_at_m")) joint.locked_at = map.number("locked_at_m", -1e3, 1e3);
    if (joint.locked) map.finish();
    entries.push_back({map, joint});
  }
  return entries;
}

void readRecorded(StrictMap& map, Actuator& a) {
  const std::string gain = a.revolute ? "torque_per_ampere_Nm" : "force_per_ampere_N";
  const bool known = map.has(gain);
  if (known)
    a.torque_per_ampere = a.revolute ? map.number("torque_per_ampere_Nm", kAboveZero, 1e6)
                                     : map.number("force_per_ampere_N", kAboveZero, 1e6);
  const std::string own = a.revolute ? "torque" : "force";
  const std::string recorded = map.choiceOr("recorded", known ? "current" : own, {own, "current"});
  a.recorded = recorded == "current" ? Recorded::Current : a.revolute ? Recorded::Torque : Recorded::Force;
}

/// Limits are for planning; what the file leaves open the URDF says. In rad or m; the actuator's are at jointRadius().
void readLimits(StrictMap& map, const ChainLimits& limits, Actuator& a) {
  const double usual = a.revolute ? kUsualRange_rad : kUsualRange_m, r = a.jointRadius();
  const bool bounded = limits.position_min < limits.position_max;
  const double low = bounded ? limits.position_min : -usual, high = bounded ? limits.position_max : usual;
  const double speed = limits.velocity_max > 0.0 ? limits.velocity_max : kUsualSpeed;
  if (a.revolute) {
    a.position_min_m = r * map.numberOr("position_min_rad", low, -1e3, 1e3);
    a.position_max_m = r * map.numberOr("position_max_rad", high, -1e3, 1e3);
    a.velocity_max_m_per_s = r * map.numberOr("velocity_max_rad_per_s", speed, kAboveZero, 1e3);
    a.acceleration_max_m_per_s2 = r * map.numberOr("acceleration_max_rad_per_s2", kUsualAcceleration, kAboveZero, 1e5);
  } else {
    a.position_min_m = map.numberOr("position_min_m", low, -1e3, 1e3);
    a.position_max_m = map.numberOr("position_max_m", high, -1e3, 1e3);
    a.velocity_max_m_per_s = map.numberOr("velocity_max_m_per_s", speed, kAboveZero, 1e3);
    a.acceleration_max_m_per_s2 = map.numberOr("acceleration_max_m_per_s2", kUsualAcceleration, kAboveZero, 1e5);
  }
  if (!(a.position_min_m < a.position_max_m)) {
    const std::string unit = positionUnit(a);
    map.refuse("position_max_" + unit, "must be greater than position_min_" + unit);
  }
  a.home_length_m = 0.5 * (a.position_min_m + a.position_max_m);
}

void readEncoder(StrictMap& map, Actuator& a) {
  a.screw_lead_m = a.revolute ? kTwoPi * kJointRadius_m : 1.0;  // per turn of a joint; a rail has none
  a.resolution_given = map.has("counts_per_revolution") || map.has("resolution_rad") || map.has("resolution_m");
  if (!a.revolute) {
    a.counts_per_revolution = 1.0 / map.numberOr("resolution_m", kUsualStep_m, kAboveZero, 1.0);
    return;
  }
  if (map.has("counts_per_revolution") && map.has("resolution_rad"))
    map.refuse("resolution_rad", "and counts_per_revolution say the same; give one");
  const double counts = kTwoPi / map.numberOr("resolution_rad", kUsualStep_rad, kAboveZero, 1.0);
  a.counts_per_revolution = map.numberOr("counts_per_revolution", counts, 1.0, 1e12);
}

Actuator readJoint(StrictMap map, const ChainJoint& joint, const ChainLimits& limits) {
  Actuator a;
  a.name = map.text("name");
  a.revolute = !joint.prismatic;
  readRecorded(map, a);
  readLimits(map, limits, a);
  readEncoder(map, a);
  a.force_per_volt_N = kForceStepPerVolt_N;
  a.voltage_max_V = kNoLimit_V;
  map.finish();
  return a;
}

}  // namespace

const char* positionUnit(const Actuator& a) {
  return a.revolute ? "rad" : "m";
}

const char* forceUnit(const Actuator& a) {
  return a.recorded == Recorded::Current ? "A" : a.recorded == Recorded::Torque ? "Nm" : "N";
}

void readChainRobot(StrictMap& file, Robot& robot) {
  robot.kind = MechanismKind::Chain;
  if (robot.urdf.empty()) file.text("urdf");  // refuses: a chain is nothing without
  const std::string base = file.text("base_link"), tip = file.text("tip_link");
  if (file.has("gravity_m_per_s2")) robot.gravity = Vector3(file.numbers("gravity_m_per_s2", 3, -100.0, 100.0).data());
  const std::vector<Entry> entries = readEntries(file);
  std::vector<NamedJoint> named;
  for (const Entry& entry : entries)
    named.push_back(entry.joint);
  std::vector<ChainLimits> limits;
  robot.chain = readChain(robot.urdf, base, tip, named, limits);
  std::vector<std::string> order;  // moving joints, as the file lists them
  for (const Entry& entry : entries) {
    if (!entry.joint.locked) order.push_back(entry.joint.name);
  }
  for (std::size_t i = 0; i < robot.chain->joints.size(); ++i) {
    const ChainJoint& joint = robot.chain->joints[i];
    if (i < order.size() && order[i] != joint.name) {
      file.refuse("joints",
                  order[i] + " stands where " + joint.name +
                      " comes from base to tip; list the joints in that order, it is that of the recording's columns");
    }
    const auto entry =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.joint.name == joint.name; });
    YAML::Emitter name;  // of the URDF, which may say what YAML would take for something else
    name << YAML::BeginMap << YAML::Key << "name" << YAML::Value << YAML::DoubleQuoted << joint.name << YAML::EndMap;
    const StrictMap own = entry == entries.end() ? StrictMap::parse(name.c_str(), robot.path) : entry->map;
    robot.actuators.push_back(readJoint(own, joint, limits[i]));
  }
}

}  // namespace knee_robot::mechanism
