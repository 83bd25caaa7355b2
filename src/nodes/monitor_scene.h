#pragma once

#include <knee_robot/ControllerState.h>
#include <knee_robot/Margins.h>
#include <knee_robot/Residual.h>
#include <knee_robot/Tracking.h>
#include <nav_msgs/Path.h>
#include <visualization_msgs/MarkerArray.h>

#include <optional>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::nodes {

/// What the monitor has heard last. Empty: nothing yet.
struct Heard {
  std::optional<ControllerState> state;
  std::optional<Tracking> tracking;
  std::optional<Margins> margins;
  std::optional<Residual> residual;
  std::optional<nav_msgs::Path> path;
  std::optional<mechanism::Pose> reference;  ///< platform pose that belongs to the reference lengths
  bool silent = false;                       ///< the controller has not been heard for a while
};

/// Markers in frame `base` for rviz, one namespace a subject, so that each can be switched off there:
///
///     reference   the reference pose as a ghost: platform, legs
///     path        rest of the loaded reference, for the platform's origin and leg 1's platform joint
///     errors      tracking error per leg as bars
///     margins     what is left to the singularity, joint angle and length limits, as bars
///     residual    the force on the platform that nobody commanded, as an arrow; what it means in words
///     text        state, and the fault
visualization_msgs::MarkerArray sceneOf(const mechanism::Robot& robot, const Heard& heard);

}  // namespace knee_robot::nodes
