#pragma once

#include <vector>

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// What each actuator has to accelerate, kg, without rotors.
struct AxisInertia {
  mechanism::Matrix4 matrix;                                       ///< forces per accelerations of the lengths at rest
  mechanism::Vector4 locked() const { return matrix.diagonal(); }  ///< the other legs stand still
  mechanism::Vector4 free() const;                                 ///< the other legs follow without force
};
/// At one pose; `payload_kg` sits at the platform's origin.
AxisInertia axisInertia(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia,
                        const mechanism::Pose& pose, double payload_kg);

/// Smallest (free) and largest (locked) over some poses.
struct AxisInertiaRange {
  mechanism::Vector4 low, high;
  int poses = 0;
};
AxisInertiaRange axisInertiaRange(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia,
                                  double payload_kg, const std::vector<mechanism::Pose>& poses);

/// A grid of the poses that the robot may take and whose condition number is at most `condition_max`: near a
/// singularity a leg alone cannot move the platform at all.
std::vector<mechanism::Pose> posesWithin(const mechanism::Robot& robot, double condition_max);

}  // namespace knee_robot::control
