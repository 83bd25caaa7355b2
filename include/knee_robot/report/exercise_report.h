#pragma once

#include <string>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/exercises.h"

namespace knee_robot {

/// A planned exercise as one SVG picture: pose against time, actuator lengths and velocities against time with their limits, and
/// the share that is left of each kind of limit (lengths, joint angles, singularity margin), with the tightest instant marked.
/// Self-contained.
std::string exerciseSvg(const Exercise& exercise, const Robot& robot, const ExercisePlan& plan);

}  // namespace knee_robot
