#pragma once

#include <string>

namespace knee_robot::nodes {

/// Where a node of this node's name lives that answers, or that stands still: the ROS master would shut it down the moment
/// that this one registers, and whoever starts a second controller by mistake would stop a robot that moves. Empty: there
/// is none, or no master. To be asked after ros::init() and before the first NodeHandle. Waits two seconds at most for a
/// node that does not answer.
std::string nodeOfTheSameName();

}  // namespace knee_robot::nodes
