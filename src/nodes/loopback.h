#pragma once

namespace knee_robot::nodes {

/// roscpp keeps its topics and services on the loopback interface when ROS_IP or ROS_HOSTNAME says 127.x or localhost,
/// but not the port on which every node answers the master: that one is bound to all interfaces, and through it anybody
/// on the network can end a node. A program that calls this (before anything of ROS starts) binds it to the loopback
/// interface, too, in that case.
void keepToLoopback();

}  // namespace knee_robot::nodes
