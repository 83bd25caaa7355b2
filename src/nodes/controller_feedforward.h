#pragma once

#include <memory>

#include "event_log.h"
#include "knee_robot/control/control_system.h"

namespace ros {
class NodeHandle;
}

namespace knee_robot::nodes {

/// Shares and payload of the feedforward under dynamic_reconfigure (`~feedforward`, cfg/Feedforward.cfg), as
/// ControllerGains. Nothing is advertised when the deployment has no ModelFeedforward.
class ControllerFeedforward {
 public:
  ControllerFeedforward(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log);
  ~ControllerFeedforward();

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace knee_robot::nodes
