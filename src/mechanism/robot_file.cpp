#include <cmath>
#include <filesystem>
#include <limits>

#include "chain_file.h"
#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/package_folders.h"
#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::mechanism {
namespace {

namespace fs = std::filesystem;

constexpr double kDefaultHome = 0.60;

double degrees(StrictMap& map, const std::string& key, double minimum, double maximum) {
  return map.number(key, minimum, maximum) * kDegree;
}

Geometry readGeometry(StrictMap map) {
  Geometry g;
  const std::vector<double> base = map.numbers("R_m", 3, kAboveZero, 10.0);
  const std::vector<double> platform = map.numbers("Rm_m", 3, kAboveZero, 10.0);
  for (int i = 0; i < 3; ++i) {
    g.R[i] = base[i];
    g.Rm[i] = platform[i];
  }
  g.ds = map.number("ds_m", -10.0, 10.0);
  g.beta_FD = degrees(map, "beta_FD_deg", -180.0, 180.0);
  g.beta_FI = degrees(map, "beta_FI_deg", -180.0, 180.0);
  g.beta_MD = degrees(map, "beta_MD_deg", -180.0, 180.0);
  g.beta_MI = degrees(map, "beta_MI_deg", -180.0, 180.0);
  map.finish();
  return g;
}

int readSign(StrictMap& map, const std::string& key) {
  const int sign = map.integerOr(key, 1, -1, 1);
  if (sign == 0) map.refuse(key, "must be 1 or -1");
  return sign;
}

void readForceLimits(StrictMap& map, Actuator& a) {
  a.force_per_volt_N = map.numberOr("force_per_volt_N", a.force_per_volt_N, kAboveZero, 1e6);
  a.force_sign = readSign(map, "force_sign");
  a.voltage_max_V = map.numberOr("voltage_max_V", a.voltage_max_V, kAboveZero, 1e3);
  a.force_continuous_N = map.numberOr("force_continuous_N", 0.0, 0.0, 1e6);
  a.force_max_N = map.numberOr("force_max_N", 0.0, 0.0, 1e6);
  if (a.force_max_N > 0.0 && a.force_continuous_N > a.force_max_N) {
    map.refuse("force_continuous_N",
               shortNumber(a.force_continuous_N) + " exceeds force_max_N " + shortNumber(a.force_max_N) + "; lower it");
  }
}

Actuator readActuator(StrictMap map, MechanismKind kind) {
  // A leg of the parallel robot has a length; a bench axis may count its position from anywhere.
  const double shortest = kind == MechanismKind::Axes ? -10.0 : kAboveZero;
  Actuator a;
  a.position_min_m = map.number("position_min_m", shortest, 10.0);
  a.position_max_m = map.number("position_max_m", shortest, 10.0);
  if (a.position_min_m >= a.position_max_m) {
    map.refuse("position_max_m",
               shortNumber(a.position_max_m) + " must be greater than position_min_m " + shortNumber(a.position_min_m));
  }
  a.velocity_max_m_per_s = map.number("velocity_max_m_per_s", kAboveZero, 100.0);
  a.acceleration_max_m_per_s2 = map.number("acceleration_max_m_per_s2", kAboveZero, 1e4);
  a.screw_lead_m = map.number("screw_lead_m", kAboveZero, 1.0);
  a.counts_per_revolution = map.number("counts_per_revolution", kAboveZero, 1e12);
  a.encoder_sign = readSign(map, "encoder_sign");
  const bool usual_home = kDefaultHome >= a.position_min_m && kDefaultHome <= a.position_max_m;
  a.home_length_m = map.numberOr("home_length_m", usual_home ? kDefaultHome : a.position_min_m, -10.0, 10.0);
  if (a.home_length_m < a.position_min_m || a.home_length_m > a.position_max_m) {
    map.refuse("home_length_m", shortNumber(a.home_length_m) + " is outside position_min_m .. position_max_m, " +
                                    shortNumber(a.position_min_m) + " .. " + shortNumber(a.position_max_m));
  }
  readForceLimits(map, a);
  map.finish();
  return a;
}

std::vector<Actuator> readActuators(StrictMap& file, MechanismKind kind) {
  std::vector<Actuator> actuators;
  for (StrictMap& entry : file.maps("actuators"))
    actuators.push_back(readActuator(entry, kind));
  const std::size_t count = actuators.size();
  if (kind == MechanismKind::Axes && (count < 1 || count > 4)) {
    file.refuse("actuators", std::to_string(count) + " entries; `mechanism: axes` needs one to four");
  }
  if (kind == MechanismKind::ThreeUpsOneRpu) {
    if (count == 1) actuators.assign(kLegs, Actuator(actuators.front()));
    if (actuators.size() != kLegs) {
      file.refuse("actuators", std::to_string(count) + " entries; give four, or one that stands for all");
    }
  }
  return actuators;
}

JointLimits readJoints(std::optional<StrictMap> map) {
  JointLimits limits{30.0 * kDegree, 45.0 * kDegree, 47.0 * kDegree};  // as built (paper, section 2.2.1)
  if (!map) return limits;
  limits.spherical_max = map->numberOr("spherical_max_deg", 30.0, kAboveZero, 180.0) * kDegree;
  limits.universal_max = map->numberOr("universal_max_deg", 45.0, kAboveZero, 180.0) * kDegree;
  limits.revolute_max = map->numberOr("revolute_max_deg", 47.0, kAboveZero, 180.0) * kDegree;
  map->finish();
  return limits;
}

double readMargin(std::optional<StrictMap> map) {
  constexpr double kDefault = 60.0;
  if (!map) return kDefault;
  // YAML's own spelling of infinity is how a file says that the margin is wide open.
  const bool open = map->has("condition_max") && map->text("condition_max") == ".inf";
  const double margin = open ? std::numeric_limits<double>::infinity()
                             : map->numberOr("condition_max", kDefault, 1.0, std::numeric_limits<double>::max());
  map->finish();
  return margin;
}

std::string resolveUrdf(StrictMap& file, const std::string& robot_path) {
  if (!file.has("urdf")) return {};
  const std::string named = file.text("urdf");
  const fs::path folder = fs::path(robot_path).parent_path();
  const std::string scheme = "package://";
  if (named.rfind(scheme, 0) != 0) {
    const fs::path path = (folder / named).lexically_normal();
    if (!fs::is_regular_file(path)) file.refuse("urdf", "no such file: " + path.string());
    return path.string();
  }
  const std::string rest = named.substr(scheme.size());
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos || slash == 0) file.refuse("urdf", "expected package://PACKAGE/FILE, not " + named);
  const std::string package = rest.substr(0, slash);
  for (const fs::path& candidate : packageFolders(package, folder.empty() ? fs::path(".") : folder)) {
    const fs::path path = (candidate / rest.substr(slash + 1)).lexically_normal();
    if (fs::is_regular_file(path)) return path.string();
  }
  file.refuse("urdf", named + " was found neither beside this file nor in ROS_PACKAGE_PATH nor in KNEE_ROBOT_PATH");
}

}  // namespace

Robot loadRobot(const std::string& path) {
  Robot robot = loadAnyRobot(path);
  if (robot.kind == MechanismKind::Chain)
    throw InputError(path +
                     ": is a chain, which only identify, trace, predict, plan_excitation and drive_gains know; give a "
                     "3UPS+1RPU or axes");
  return robot;
}

Robot loadAnyRobot(const std::string& path) {
  const std::string text = readFile(path, 16u << 20);
  StrictMap file = StrictMap::parse(text, path);
  Robot robot;
  robot.path = path;
  robot.fingerprint = fingerprint(text);
  const std::string kind = file.choice("mechanism", {"3UPS+1RPU", "axes", "chain"});
  if (kind == "chain") {
    robot.urdf = resolveUrdf(file, path);
    readChainRobot(file, robot);
    file.finish();
    return robot;
  }
  const bool parallel = kind == "3UPS+1RPU";
  robot.kind = parallel ? MechanismKind::ThreeUpsOneRpu : MechanismKind::Axes;
  // A bench file needs only `actuators`; what else of a robot file stands there must still be right.
  if (parallel || file.has("geometry")) {
    const Mechanism mechanism(readGeometry(file.map("geometry")));
    if (parallel) robot.mechanism = mechanism;
  }
  if (file.has("gravity_m_per_s2")) {
    robot.gravity = Vector3(file.numbers("gravity_m_per_s2", 3, -100.0, 100.0).data());
  }
  robot.actuators = readActuators(file, robot.kind);
  robot.joints = readJoints(file.mapIfAny("joints"));
  robot.singularity_condition_max = readMargin(file.mapIfAny("singularity_margin"));
  robot.urdf = resolveUrdf(file, path);
  file.finish();
  return robot;
}

}  // namespace knee_robot::mechanism
