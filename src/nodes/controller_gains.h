#pragma once

#include <memory>

#include "event_log.h"
#include "knee_robot/control/control_system.h"

namespace ros {
class NodeHandle;
}

namespace knee_robot::nodes {

/// The Drivers' gains under dynamic_reconfigure (`~gains`, cfg/Gains.cfg): bounded there and by the Drivers, taken over
/// without a jump of force. They start with what the Drivers have (the deployment file's values), not with cfg's
/// defaults nor with the parameter server's; a change that the Driver refuses is shown as not made.
class ControllerGains {
 public:
  ControllerGains(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log);
  ~ControllerGains();

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace knee_robot::nodes
