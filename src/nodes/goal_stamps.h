#pragma once

#include <actionlib/server/action_server.h>
#include <knee_robot/PlayAction.h>

namespace actionlib {

/// actionlib adds a time-out to stamps of goals and cancels as clients wrote them; with one near the end of ROS time
/// (2106) that throws in whatever thread comes along, for ever. This one compares without adding. Every source that uses
/// the action's server has to include this.
template <>
void ActionServer<knee_robot::PlayAction>::publishStatus();

}  // namespace actionlib
