#pragma once

#include <knee_robot/ControllerState.h>
#include <ros/ros.h>

#include <array>
#include <optional>
#include <string>

#include "knee_robot/control/control_system.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::nodes {

/// The message that describes the machine's state, stamped now.
ControllerState stateMessage(const control::ControlSystem& system);

/// Publishes what the controller knows, from a thread of its own and lock-free snapshots: a slow subscriber loses
/// messages (queues of kTopicQueue), and never reaches the real-time side. Stamps say when positions were read.
///
///     ~tracking            knee_robot/Tracking        at rate_hz: reference, position, error, command, force
///     joint_states         sensor_msgs/JointState     at rate_hz: the paper's 15 coordinates, velocities, forces
///     urdf_joint_states    sensor_msgs/JointState     at rate_hz: the URDF's 13 joints, for robot_state_publisher
///     ~pose                geometry_msgs/PoseStamped  at rate_hz: platform pose by forward kinematics, frame `base`
///     ~state               knee_robot/ControllerState latched; on every change and every half second
///     ~margins             knee_robot/Margins         10 Hz
///     ~forces              knee_robot/Forces          10 Hz
///     ~residual            knee_robot/Residual        10 Hz, where the deployment has a DisturbanceObserver
///     ~timing              knee_robot/Timing          1 Hz
class ControllerTopics {
 public:
  /// `node`: the private namespace; its callback queue carries the timer.
  ControllerTopics(ros::NodeHandle& node, const control::ControlSystem& system, const mechanism::Robot& robot,
                   double rate_hz);

 private:
  void publish();
  ros::Time stampOf(const control::TrackingRow& row, const ros::Time& now);
  void publishTracking(const control::TrackingRow& row, const ros::Time& stamp);
  void followPose(const control::TrackingRow& row);
  void publishJoints(const control::TrackingRow& row, const ros::Time& stamp);
  void publishState();
  void publishResidual(const ros::Time& stamp);
  void publishForces(const control::TrackingRow& row, const ros::Time& stamp);

  const control::ControlSystem& system_;
  const mechanism::Robot& robot_;
  const double period_s_;
  ros::Publisher tracking_, joints_, urdf_joints_, pose_, state_, margins_, forces_, residual_, timing_;
  mechanism::ForwardResult forward_;  // newest pose: the guess for the next one
  std::string last_state_;
  ros::SteadyTime state_at_, slow_at_, timing_at_;
  double measured_at_s_ = -1.0;                        // of the row that was published last,
  ros::Time measured_at_;                              // and its stamp
  std::array<double, hardware::kAxes> mean_square_{};  // N^2
  std::vector<rt::DurationHistogram::Snapshot> timing_before_;
  ros::SteadyTimer timer_;  // last: goes first
};

}  // namespace knee_robot::nodes
