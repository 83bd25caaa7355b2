#pragma once

#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::trajectory {

/// Condition number that plans stay below although a robot file leaves its margin wide open: a plan is a choice, and a
/// choice keeps away from singularities.
inline constexpr double kPlanningCondition = 60.0;
/// A singularity margin beyond this one is no margin.
inline constexpr double kWideOpenCondition = 1000.0;

/// The robot file's singularity margin, or kPlanningCondition when that is wide open.
double planningCondition(const mechanism::Robot& robot);

/// Sign of det(dq/dx) on the branch in which the robot is built: of a level pose over the base (as in
/// forwardKinematicsFromHome). It is positive for the paper's final geometry and negative for robot B's.
double homeBranch(const mechanism::Robot& robot);

/// The limit that is nearest at `pose`: lengths, joint angles, condition number against `condition_max`. `left` is
/// normalised:
/// 1 in the middle of a length's range, at a straight joint, far from singularity; 0 at a limit, negative beyond it. A
/// pose with another sign of det(dq/dx) than homeBranch or with the platform below the base is of another branch: left
/// = -1 (Assembly).
Margin nearestLimit(const mechanism::Robot& robot, const mechanism::Pose& pose, double condition_max);

/// "the spherical joint of leg 2 (31.2 deg, limit 30 deg)" and the like, for sentences about a pose.
std::string limitText(const Margin& margin);

}  // namespace knee_robot::trajectory
