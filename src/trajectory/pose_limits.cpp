#include "knee_robot/trajectory/pose_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::trajectory {
namespace {

void keepNearest(Margin& nearest, Quantity quantity, double value, double limit, int actuator, double left) {
  if (left >= nearest.left) return;
  nearest.quantity = quantity;
  nearest.value = value;
  nearest.limit = limit;
  nearest.actuator = actuator;
  nearest.left = left;
}

}  // namespace

double homeBranch(const mechanism::Robot& robot) {
  const mechanism::Actuator& leg = robot.actuators[3];
  const double length = 0.5 * (leg.position_min_m + leg.position_max_m), reach = robot.mechanism->geometry.ds;
  const mechanism::Pose level(0.0, std::sqrt(std::max(length * length - reach * reach, 0.01 * length * length)), 0.0,
                              0.0);
  return mechanism::lengthJacobian(*robot.mechanism, level).determinant() < 0.0 ? -1.0 : 1.0;
}

double planningCondition(const mechanism::Robot& robot) {
  const bool wide_open = robot.singularity_condition_max > kWideOpenCondition;
  return wide_open ? kPlanningCondition : robot.singularity_condition_max;
}

Margin nearestLimit(const mechanism::Robot& robot, const mechanism::Pose& pose, double condition_max) {
  Margin nearest;
  nearest.left = std::numeric_limits<double>::infinity();
  const mechanism::Mechanism& mechanism = *robot.mechanism;
  const mechanism::Lengths lengths = mechanism::legLengths(mechanism, pose);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    const double half = 0.5 * (actuator.position_max_m - actuator.position_min_m);
    keepNearest(nearest, Quantity::ShortestLength, lengths[i], actuator.position_min_m, i + 1,
                (lengths[i] - actuator.position_min_m) / half);
    keepNearest(nearest, Quantity::LongestLength, lengths[i], actuator.position_max_m, i + 1,
                (actuator.position_max_m - lengths[i]) / half);
  }
  const mechanism::JointAngles angles = mechanism::jointAngles(mechanism, pose);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const double base_max = i < 3 ? robot.joints.universal_max : robot.joints.revolute_max;
    keepNearest(nearest, Quantity::BaseAngle, angles.base[i], base_max, i + 1, 1.0 - angles.base[i] / base_max);
    if (i == 3) continue;
    const double platform_max = robot.joints.spherical_max;
    keepNearest(nearest, Quantity::PlatformAngle, angles.platform[i], platform_max, i + 1,
                1.0 - angles.platform[i] / platform_max);
  }
  const double condition = mechanism::conditionNumber(mechanism, pose);
  keepNearest(nearest, Quantity::Condition, condition, condition_max, 0, 1.0 - condition / condition_max);
  const bool usual_branch =
      pose[1] > 0.0 && mechanism::lengthJacobian(mechanism, pose).determinant() * homeBranch(robot) > 0.0;
  if (!usual_branch)
    keepNearest(nearest, Quantity::Assembly, condition, condition_max, 0, std::min(-1.0, nearest.left));
  return nearest;
}

std::string limitText(const Margin& margin) {
  const std::string leg = std::to_string(margin.actuator);
  const auto of = [&](double scale, const char* unit) {
    return " (" + shortNumber(scale * margin.value, 4) + unit + ", limit " + shortNumber(scale * margin.limit, 4) +
           unit + ")";
  };
  switch (margin.quantity) {
    case Quantity::ShortestLength:
    case Quantity::LongestLength:
      return "the length of leg " + leg + of(1.0, " m");
    case Quantity::Velocity:
      return "the velocity of actuator " + leg + of(1.0, " m/s");
    case Quantity::Acceleration:
      return "the acceleration of actuator " + leg + of(1.0, " m/s2");
    case Quantity::BaseAngle:
      return std::string("the ") + (margin.actuator == 4 ? "revolute" : "universal") + " joint of leg " + leg +
             of(kDegrees, " deg");
    case Quantity::PlatformAngle:
      return "the spherical joint of leg " + leg + of(kDegrees, " deg");
    case Quantity::Condition:
      return "the singularity margin" + of(1.0, "");
    case Quantity::Assembly:
      break;
  }
  return "a singularity on the way";
}

}  // namespace knee_robot::trajectory
