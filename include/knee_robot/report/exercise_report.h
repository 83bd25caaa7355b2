#pragma once

#include <string>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/exercises.h"

namespace knee_robot {

/// A planned exercise as one SVG picture: pose against time, actuator lengths and velocities against time with their limits, and
/// the share that is left of each kind of limit (lengths, joint angles, singularity margin), with the tightest instant marked.
/// Self-contained.
std::string exerciseSvg(const Exercise& exercise, const Robot& robot, const ExercisePlan& plan);

/// Several plots, each as svgPlot writes it, below each other in one <svg> file with a title.
std::string stackedSvg(const std::string& title, const std::vector<std::string>& plots, double width,
                       const std::vector<double>& heights);

}  // namespace knee_robot
