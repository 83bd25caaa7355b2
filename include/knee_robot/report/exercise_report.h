#pragma once

#include <string>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/exercises.h"

namespace knee_robot::report {

/// A planned exercise as one SVG picture: pose against time, actuator lengths and velocities against time with their
/// limits, and the share that is left of each kind of limit (lengths, joint angles, singularity margin), with the
/// tightest instant marked.
/// Self-contained.
std::string exerciseSvg(const trajectory::Exercise& exercise, const mechanism::Robot& robot,
                        const trajectory::ExercisePlan& plan);

}  // namespace knee_robot::report
