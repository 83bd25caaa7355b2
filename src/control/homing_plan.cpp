#include "homing_plan.h"

#include <algorithm>
#include <cmath>

#include "home_lengths.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {
namespace {

constexpr double kStep_m = 0.0005;
constexpr double kCondition = 100.0;  // unless the robot file wants less: half a millimetre from where the legs lock

constexpr double kBeside_m = 0.015;  // who places it by eye puts it so far above or below home

/// One axis after the other, on the branch on which the robot was built.
class Walk {
 public:
  Walk(const mechanism::Robot& robot, const mechanism::Lengths& from)
      : mechanism_(*robot.mechanism),
        limit_(std::min(robot.singularity_condition_max, kCondition)),
        lengths_(from),
        found_(mechanism::forwardKinematicsFromHome(mechanism_, from)) {}
  /// Moves one axis. False: at lengths() it cannot go on.
  bool goTo(int axis, double length_m) {
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(length_m - lengths_[axis]) / kStep_m)));
    const double step_m = (length_m - lengths_[axis]) / steps;
    for (int k = 0; k < steps && isWell(); ++k) {
      lengths_[axis] += step_m;
      found_ = mechanism::forwardKinematics(mechanism_, lengths_, found_.pose);
    }
    return isWell();
  }
  const mechanism::Lengths& lengths() const { return lengths_; }

 private:
  bool isWell() const { return found_.ok() && mechanism::conditionNumber(mechanism_, found_.pose) <= limit_; }

  const mechanism::Mechanism& mechanism_;
  const double limit_;
  mechanism::Lengths lengths_;
  mechanism::ForwardResult found_;
};

std::string whyNotHomedFrom(const mechanism::Lengths& start, const mechanism::Robot& robot,
                            const HardwareFile& hardware) {
  Walk walk(robot, start);
  for (const int axis : hardware.homing.order) {
    const HomingAxis& way = hardware.homing.axes[static_cast<std::size_t>(axis - 1)];
    const double back_m = way.length_m - way.direction * way.back_off_m;
    if (walk.goTo(axis - 1, way.length_m) && walk.goTo(axis - 1, back_m)) continue;
    return "homing: from about home, axis " + std::to_string(axis) + " does not reach its length_m " +
           shortNumber(way.length_m) + ": at " + shortNumber(walk.lengths()[axis - 1], 4) +
           " m the platform is near a singularity, where an axis stands as at its stop; choose another order, "
           "length_m or method";
  }
  return "";
}

}  // namespace

std::string whyNotHomed(const mechanism::Robot& robot, const HardwareFile& hardware) {
  if (!hardware.homing.moves() || !robot.mechanism) return "";
  const mechanism::Lengths home = homeLengths(robot);
  const mechanism::ForwardResult at_home = mechanism::forwardKinematicsFromHome(*robot.mechanism, home);
  for (const double beside_m : {0.0, kBeside_m, -kBeside_m}) {
    mechanism::Pose pose = at_home.pose;
    pose[1] += beside_m;
    const mechanism::Lengths start = at_home.ok() ? mechanism::legLengths(*robot.mechanism, pose) : home;
    const std::string why = whyNotHomedFrom(start, robot, hardware);
    if (!why.empty()) return why;
  }
  return "";
}

}  // namespace knee_robot::control
