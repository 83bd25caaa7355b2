#pragma once

#include <knee_robot/CheckReference.h>
#include <knee_robot/GetState.h>
#include <knee_robot/LoadReference.h>
#include <knee_robot/SetRecording.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <vector>

#include "folder.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot {

/// The operator's commands as services. Every answer says what happened, or why it did not.
///
///     ~check_reference, ~load_reference   files of the references folder only
///     ~enable, ~disable, ~approach, ~start, ~stop, ~emergency_stop, ~reset_faults   std_srvs/Trigger
///     ~set_recording, ~get_state
class ControllerServices {
 public:
  ControllerServices(ros::NodeHandle& node, ControlSystem& system, const Robot& robot, const Folder& references,
                     const Folder& recordings);

 private:
  bool check(CheckReference::Request& request, CheckReference::Response& response);
  bool load(LoadReference::Request& request, LoadReference::Response& response);
  bool record(SetRecording::Request& request, SetRecording::Response& response);
  bool getState(GetState::Request& request, GetState::Response& response);
  void offer(ros::NodeHandle& node, const std::string& name, Answer (ControlSystem::*command)());

  ControlSystem& system_;
  const Robot& robot_;
  const Folder& references_;
  const Folder& recordings_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace knee_robot
