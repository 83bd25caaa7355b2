#include "knee_robot/control/patient_limits.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::control {
namespace {

constexpr std::size_t kLargestFile = 1u << 20;

struct Coordinate {
  const char* key;   // in the file
  const char* name;  // in sentences
  double unit;       // SI per unit of the file and of sentences
  const char* unit_name;
};
constexpr Coordinate kCoordinates[4] = {{"X_m", "Xm", 1.0, "m"},
                                        {"Z_m", "Zm", 1.0, "m"},
                                        {"theta_deg", "theta", kDegree, "deg"},
                                        {"psi_deg", "psi", kDegree, "deg"}};

double longestLeg(const mechanism::Robot& robot) {
  double longest = 0.0;
  for (const mechanism::Actuator& actuator : robot.actuators)
    longest = std::max(longest, actuator.position_max_m);
  return longest;
}

double slowestLimit(const mechanism::Robot& robot) {
  double slowest = robot.actuators.front().velocity_max_m_per_s;
  for (const mechanism::Actuator& actuator : robot.actuators)
    slowest = std::min(slowest, actuator.velocity_max_m_per_s);
  return slowest;
}

void readPose(StrictMap map, double reach_m, PatientRange& range) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Coordinate& coordinate = kCoordinates[i];
    const double bound = i < 2 ? reach_m : 90.0;
    const std::vector<double> ends = map.numbers(coordinate.key, 2, -bound, bound);
    if (!(ends[0] < ends[1])) map.refuse(coordinate.key, "expected [smallest, largest] with the smallest first");
    range.minimum[i] = ends[0] * coordinate.unit;
    range.maximum[i] = ends[1] * coordinate.unit;
  }
  map.finish();
}

}  // namespace

bool PatientRange::contains(const mechanism::Pose& pose, double margin_m, double margin_rad) const noexcept {
  for (int i = 0; i < 4; ++i) {
    const double margin = i < 2 ? margin_m : margin_rad;
    const auto k = static_cast<std::size_t>(i);
    if (!(pose[i] >= minimum[k] - margin && pose[i] <= maximum[k] + margin)) return false;
  }
  return true;
}

bool PatientRange::allowsForce(const std::array<double, 4>& wrench) const noexcept {
  return std::hypot(wrench[0], wrench[1]) <= force_N && std::abs(wrench[2]) <= moment_Nm &&
         std::abs(wrench[3]) <= moment_Nm;
}

bool PatientRange::allowsSpeed(const mechanism::Vector4& speed, double factor) const noexcept {
  return std::hypot(speed[0], speed[1]) <= factor * linear_m_per_s &&
         std::abs(speed[2]) <= factor * angular_rad_per_s && std::abs(speed[3]) <= factor * angular_rad_per_s;
}

PatientLimits loadPatientLimits(const std::string& path, const mechanism::Robot& robot) {
  if (!robot.mechanism) {
    throw InputError(path + ": a patient needs the platform, and " + robot.path + " describes axes on a bench");
  }
  const std::string content = readFile(path, kLargestFile);
  StrictMap file = StrictMap::parse(content, path);
  PatientLimits patient;
  patient.path = path;
  patient.mark = fingerprint(content);
  patient.name = file.text("patient");
  if (patient.name.empty()) file.refuse("patient", "expected initials or a number, for messages and recordings");
  readPose(file.map("pose"), longestLeg(robot), patient.range);
  if (auto speed = file.mapIfAny("speed")) {
    PatientRange& range = patient.range;
    const double fastest = 1e3 * slowestLimit(robot);  // the platform is never meant to be faster than the legs
    range.linear_m_per_s = 1e-3 * speed->numberOr("linear_mm_per_s", std::min(20.0, fastest), 0.1, fastest);
    range.angular_rad_per_s = kDegree * speed->numberOr("angular_deg_per_s", 2.0, 0.01, 30.0);
    speed->finish();
  } else {
    patient.range.linear_m_per_s = std::min(patient.range.linear_m_per_s, slowestLimit(robot));
  }
  if (auto force = file.mapIfAny("force")) {
    const double infinite = std::numeric_limits<double>::infinity();
    patient.range.force_N = force->numberOr("force_N", infinite, 5.0, 1000.0);
    patient.range.moment_Nm = force->numberOr("moment_Nm", infinite, 1.0, 300.0);
    force->finish();
  }
  file.finish();
  patient.range.given = true;
  return patient;
}

void requireWithinPatient(const trajectory::ReferenceCheck& check, const trajectory::Reference& reference,
                          const PatientLimits& patient) {
  const auto refuse = [&](Eigen::Index k, const std::string& what) {
    throw InputError(reference.name + ":" + std::to_string(reference.lineOf(k)) + ": " + what + " (patient " +
                     patient.name + ", " + patient.path + ")");
  };
  const PatientRange& range = patient.range;
  if (check.poses.rows() == 0)
    refuse(0, "the platform's poses are not known, so the patient's limits cannot be checked");
  constexpr double kRounding = 1e-9;       // m, rad
  constexpr double kSpeedRounding = 1e-5;  // of coordinates written with nanometres, 10 ms apart
  for (Eigen::Index k = 0; k < check.poses.rows(); ++k) {
    const mechanism::Pose pose = check.poses.row(k).transpose();
    for (int i = 0; i < 4; ++i) {
      const Coordinate& c = kCoordinates[i];
      const auto at = static_cast<std::size_t>(i);
      if (pose[i] >= range.minimum[at] - kRounding && pose[i] <= range.maximum[at] + kRounding) continue;
      refuse(k, std::string(c.name) + " is " + shortNumber(pose[i] / c.unit, 4) + " " + c.unit_name +
                    ", outside the patient's " + shortNumber(range.minimum[at] / c.unit, 4) + " .. " +
                    shortNumber(range.maximum[at] / c.unit, 4));
    }
    if (k == 0) continue;
    const mechanism::Vector4 speed =
        (pose - mechanism::Pose(check.poses.row(k - 1).transpose())) / trajectory::kStreamPeriod;
    if (std::hypot(speed[0], speed[1]) > range.linear_m_per_s + kSpeedRounding) {
      refuse(k, "the platform moves at " + shortNumber(1e3 * std::hypot(speed[0], speed[1]), 4) +
                    " mm/s, faster than the patient's " + shortNumber(1e3 * range.linear_m_per_s, 4) +
                    "; play it at a lower speed or plan it slower");
    }
    const double turning = std::max(std::abs(speed[2]), std::abs(speed[3]));
    if (turning > range.angular_rad_per_s + kSpeedRounding) {
      refuse(k, "the platform turns at " + shortNumber(turning / kDegree, 4) + " deg/s, faster than the patient's " +
                    shortNumber(range.angular_rad_per_s / kDegree, 4) + "; plan it slower");
    }
  }
}

}  // namespace knee_robot::control
