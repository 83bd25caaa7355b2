#pragma once

#include <knee_robot/ListComponents.h>
#include <knee_robot/SetProperty.h>
#include <ros/ros.h>

#include "event_log.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// The running components over ROS: ~list_components (state, ports, properties, operations) and ~set_property. Both
/// only read or write what components publish for other threads (atomic states and values): the servo thread waits for
/// neither.
class ControllerComponents {
 public:
  ControllerComponents(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log);

 private:
  bool list(ListComponents::Request& request, ListComponents::Response& response);
  bool set(ros::ServiceEvent<SetProperty::Request, SetProperty::Response>& call);

  control::ControlSystem& system_;
  EventLog& log_;
  ros::ServiceServer list_, set_;
};

}  // namespace knee_robot::nodes
