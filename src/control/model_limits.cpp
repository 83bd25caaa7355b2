#include "model_limits.h"

#include <algorithm>
#include <cmath>

#include "home_lengths.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {
namespace {

constexpr double kAround_m = 0.02;
constexpr double kGentle_m_per_s = 0.05, kGentle_m_per_s2 = 0.1;
constexpr double kPushes = 0.1;  ///< of what the drive gives: more friction along the motion drives it on
constexpr double kStep_s = 0.01;
constexpr int kSteps = 50;

std::string sentence(Eigen::Index axis, double force_N, const char* where, double limit_N) {
  return "asks axis " + std::to_string(axis + 1) + " for " + shortNumber(force_N, 3) + " N " + where +
         ", its drive gives " + shortNumber(limit_N, 3) + " N";
}

/// One axis begins to move at the pose of these lengths, the others rest: what is asked of each at rest and on the way.
std::string tooMuchAt(const dynamics::PartedModel& model, const mechanism::Robot& robot, const mechanism::Pose& pose,
                      const mechanism::Lengths& lengths, double share) {
  for (int moved = 0; moved < 2 * mechanism::kLegs; ++moved) {
    const Eigen::Index axis = moved / 2;
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(axis)];
    const double direction = moved % 2 == 0 ? 1.0 : -1.0;
    dynamics::ForcePartsData data;
    dynamics::ForceParts parts;
    dynamics::WantedInstant at;
    at.period_s = kStep_s;
    at.position_m = lengths;
    at.velocity_m_per_s[axis] = direction * std::min(kGentle_m_per_s, a.velocity_max_m_per_s);
    at.acceleration_m_per_s2[axis] = direction * std::min(kGentle_m_per_s2, a.acceleration_max_m_per_s2);
    for (int k = 0; k < kSteps; ++k) {
      if (!dynamics::forceParts(model, pose, at, data, parts)) return "";
      for (Eigen::Index i = 0; i < mechanism::kLegs; ++i) {
        const double limit_N = robot.actuators[static_cast<std::size_t>(i)].forceLimit();
        const double moves_N = parts.friction[i] + parts.inertia[i];
        if (!(std::abs(parts.gravity[i]) <= share * limit_N))
          return sentence(i, parts.gravity[i], "at rest near home", limit_N);
        if (!(std::abs(moves_N) <= share * limit_N))
          return sentence(i, moves_N, "to move at 50 mm/s near home", limit_N);
      }
      if (direction * parts.friction[axis] < -kPushes * a.forceLimit())
        return "gives axis " + std::to_string(axis + 1) + " friction that pushes it on, with " +
               shortNumber(std::abs(parts.friction[axis]), 3) + " N at 50 mm/s";
    }
  }
  return "";
}

}  // namespace

std::string whatIsTooMuch(const dynamics::PartedModel& model, const mechanism::Robot& robot, double share) {
  if (!robot.mechanism) return "";
  const mechanism::Lengths home = homeLengths(robot);
  for (int k = -1; k < 2 * mechanism::kLegs; ++k) {
    mechanism::Lengths lengths = home;
    if (k >= 0) lengths[k / 2] += k % 2 == 0 ? kAround_m : -kAround_m;
    const mechanism::ForwardResult found = mechanism::forwardKinematicsFromHome(*robot.mechanism, lengths);
    if (!found.ok()) continue;
    const std::string found_too_much = tooMuchAt(model, robot, found.pose, lengths, share);
    if (!found_too_much.empty()) return found_too_much;
  }
  return "";
}

}  // namespace knee_robot::control
