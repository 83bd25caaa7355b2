#include "controller_topics.h"

#include <geometry_msgs/PoseStamped.h>
#include <knee_robot/Tracking.h>
#include <sensor_msgs/JointState.h>

#include <Eigen/Geometry>

#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot {
namespace {

constexpr const char* kBaseFrame = "base";
constexpr double kStatePeriod = 0.5;  // s, without a change

}  // namespace

ControllerState stateMessage(const ControlSystem& system) {
  const ControlStatus status = system.status();
  ControllerState message;
  message.header.stamp = ros::Time::now();
  message.state = toString(status.state);
  message.fault = status.fault_name;
  message.cause = status.fault_sentence;
  message.reference_file = status.reference;
  message.duration_s = status.path_duration_s;
  message.path_time_s = status.path_time_s;
  message.recording = !status.recording.empty();
  message.dropped_rows = status.dropped_rows;
  for (const auto& activity : system.deployment().activities())
    message.missed_cycles += activity->statistics().missed.load();
  return message;
}

ControllerTopics::ControllerTopics(ros::NodeHandle& node, const ControlSystem& system, const Robot& robot,
                                   double rate_hz)
    : system_(system),
      robot_(robot),
      tracking_(node.advertise<Tracking>("tracking", 10)),
      joints_(node.advertise<sensor_msgs::JointState>("joint_states", 10)),
      pose_(node.advertise<geometry_msgs::PoseStamped>("pose", 10)),
      state_(node.advertise<ControllerState>("state", 10, true)),
      timer_(node.createTimer(ros::Duration(1.0 / rate_hz), [this](const ros::TimerEvent&) { publish(); })) {}

void ControllerTopics::publish() {
  if (const std::optional<TrackingRow> row = system_.snapshot()) {
    publishTracking(*row);
    if (robot_.mechanism) publishJoints(*row);
  }
  publishState();
}

void ControllerTopics::publishTracking(const TrackingRow& row) {
  Tracking message;
  message.header.stamp = ros::Time::now();
  message.sequence = row.sequence;
  message.path_time_s = row.path_time_s;
  for (int i = 0; i < kAxes; ++i) {
    message.reference_m[i] = row.reference_m[i];
    message.position_m[i] = row.position_m[i];
    message.error_m[i] = row.reference_m[i] - row.position_m[i];
    message.velocity_m_per_s[i] = row.velocity_m_per_s[i];
    message.command_V[i] = row.command_V[i];
    message.force_N[i] = row.force_N[i];
  }
  tracking_.publish(message);
}

void ControllerTopics::publishJoints(const TrackingRow& row) {
  const Mechanism& mechanism = *robot_.mechanism;
  const Lengths lengths(row.position_m.data());
  forward_ = forward_.ok() ? forwardKinematics(mechanism, lengths, forward_.pose)
                           : forwardKinematicsFromHome(mechanism, lengths);
  if (!forward_.ok()) {
    ROS_WARN_THROTTLE(5.0, "no platform pose belongs to the measured lengths: joint states and pose are not published");
    return;
  }
  sensor_msgs::JointState joints;
  joints.header.stamp = ros::Time::now();
  const auto& names = urdfJointNames();
  const auto positions = urdfJointPositions(mechanism, forward_.pose);
  joints.name.assign(names.begin(), names.end());
  joints.position.assign(positions.begin(), positions.end());
  joints_.publish(joints);

  geometry_msgs::PoseStamped pose;
  pose.header = joints.header;
  pose.header.frame_id = kBaseFrame;
  pose.pose.position.x = forward_.pose[0];
  pose.pose.position.z = forward_.pose[1];
  const Eigen::Quaterniond turn(platformRotation(forward_.pose));
  pose.pose.orientation.x = turn.x();
  pose.pose.orientation.y = turn.y();
  pose.pose.orientation.z = turn.z();
  pose.pose.orientation.w = turn.w();
  pose_.publish(pose);
}

void ControllerTopics::publishState() {
  const ControllerState message = stateMessage(system_);
  const std::string summary = message.state + '\n' + message.fault + '\n' + message.reference_file + '\n' +
                              (message.recording ? "recording" : "") + std::to_string(message.dropped_rows);
  if (summary == last_state_ && (message.header.stamp - last_state_at_).toSec() < kStatePeriod) return;
  if (!message.fault.empty() && summary != last_state_)
    ROS_ERROR("%s: %s", message.fault.c_str(), message.cause.c_str());
  last_state_ = summary;
  last_state_at_ = message.header.stamp;
  state_.publish(message);
}

}  // namespace knee_robot
