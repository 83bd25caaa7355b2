#pragma once

#include <knee_robot/ControllerState.h>
#include <ros/ros.h>

#include <string>

#include "knee_robot/control/control_system.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot {

/// The message that describes `status`, stamped now.
ControllerState stateMessage(const ControlSystem& system);

/// Publishes what the controller knows, at a rate of its own, from lock-free snapshots: a slow subscriber never reaches the
/// real-time side.
///
///     ~tracking      knee_robot/Tracking        reference, position, error, command, force per actuator
///     ~joint_states  sensor_msgs/JointState     all joints of the URDF, passive ones by forward kinematics
///     ~pose          geometry_msgs/PoseStamped  platform pose by forward kinematics, frame `base`
///     ~state         knee_robot/ControllerState latched; on every change and every half second
class ControllerTopics {
 public:
  ControllerTopics(ros::NodeHandle& node, const ControlSystem& system, const Robot& robot, double rate_hz);

 private:
  void publish();
  void publishTracking(const TrackingRow& row);
  void publishJoints(const TrackingRow& row);
  void publishState();

  const ControlSystem& system_;
  const Robot& robot_;
  ros::Publisher tracking_, joints_, pose_, state_;
  ros::Timer timer_;
  ForwardResult forward_;  // newest pose: the guess for the next one
  std::string last_state_;
  ros::Time last_state_at_;
};

}  // namespace knee_robot
