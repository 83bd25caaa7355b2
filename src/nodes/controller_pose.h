#pragma once

#include <geometry_msgs/Pose.h>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::nodes {

/// Frame of the base: Z up, see the URDF.
inline constexpr const char* kBaseFrame = "base";

/// The platform's pose (Xm, Zm, theta, psi) in the base frame, in ROS's form.
geometry_msgs::Pose poseMessage(const mechanism::Pose& pose);
/// The same back; angles by eq. (5).
mechanism::Pose poseOf(const geometry_msgs::Pose& message);

}  // namespace knee_robot::nodes
