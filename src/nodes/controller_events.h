#pragma once

#include <knee_robot/GetEvents.h>
#include <ros/ros.h>

#include <string>

#include "event_log.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// The event log over ROS: ~events (every entry, latched) and ~get_events (those of before). Adds the machine's states
/// and faults.
class ControllerEvents {
 public:
  /// `node`: the private namespace; its callback queue carries the timer.
  ControllerEvents(ros::NodeHandle& node, const control::ControlSystem& system, EventLog& log);
  ~ControllerEvents() { log_.setListener({}); }

 private:
  void poll();
  void publish(const LoggedEvent& event);
  bool get(GetEvents::Request& request, GetEvents::Response& response);

  const control::ControlSystem& system_;
  EventLog& log_;
  ros::Publisher publisher_;
  ros::ServiceServer get_;
  std::string last_;
  ros::WallTimer timer_;  // last: goes first
};

/// Who sent a goal, as its id says by the usual rule NAME-COUNT-TIME: actionlib does not tell the connection.
std::string callerOfGoal(const std::string& goal_id);

}  // namespace knee_robot::nodes
