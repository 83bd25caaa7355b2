#include "controller_topics.h"

#include <geometry_msgs/PoseStamped.h>
#include <knee_robot/Forces.h>
#include <knee_robot/Tracking.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller_messages.h"
#include "controller_pose.h"

namespace knee_robot::nodes {
namespace {

constexpr std::uint32_t kTopicQueue = 10;  // a subscriber that is slower than this loses the oldest
constexpr double kStatePeriod = 0.5;       // s, without a change
constexpr double kSlowPeriod = 0.1;        // s, margins and forces
constexpr double kTimingPeriod = 1.0;      // s
constexpr double kForceWindow = 10.0;      // s

bool isDue(ros::SteadyTime& last, const ros::SteadyTime& now, double period_s) {
  if (!last.isZero() && (now - last).toSec() < period_s) return false;
  last = now;
  return true;
}

}  // namespace

ControllerState stateMessage(const control::ControlSystem& system) {
  const control::ControlStatus status = system.status();
  ControllerState message;
  message.header.stamp = ros::Time::now();
  message.state = control::toString(status.state);
  message.fault = status.fault_name;
  message.cause = status.fault_sentence.empty() ? status.guiding : status.fault_sentence;
  message.reference_file = status.reference;
  message.at_start = status.at_start;
  message.duration_s = status.path_duration_s;
  message.path_time_s = status.path_time_s;
  message.patient = status.patient;
  message.occupancy = toString(status.occupancy);
  message.playing = status.playing;
  message.progress = status.progress;
  message.time_scale = status.time_scale;
  message.speed_percent = status.speed_percent;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    message.homed[i] = status.axis_homed[i];
  message.recording = !status.recording.empty();
  message.dropped_rows = status.dropped_rows;
  for (const auto& activity : system.deployment().activities())
    message.missed_cycles += activity->statistics().missed.load();
  return message;
}

ControllerTopics::ControllerTopics(ros::NodeHandle& node, const control::ControlSystem& system,
                                   const mechanism::Robot& robot, double rate_hz)
    : system_(system),
      robot_(robot),
      period_s_(1.0 / rate_hz),
      tracking_(node.advertise<Tracking>("tracking", kTopicQueue)),
      joints_(node.advertise<sensor_msgs::JointState>("joint_states", kTopicQueue)),
      urdf_joints_(node.advertise<sensor_msgs::JointState>("urdf_joint_states", kTopicQueue)),
      pose_(node.advertise<geometry_msgs::PoseStamped>("pose", kTopicQueue)),
      state_(node.advertise<ControllerState>("state", kTopicQueue, true)),
      margins_(node.advertise<Margins>("margins", kTopicQueue)),
      forces_(node.advertise<Forces>("forces", kTopicQueue)),
      residual_(node.advertise<Residual>("residual", kTopicQueue)),
      timing_(node.advertise<Timing>("timing", kTopicQueue)) {
  timingMessage(system_.deployment(), timing_before_);
  timing_at_ = ros::SteadyTime::now();
  timer_ = node.createSteadyTimer(ros::WallDuration(period_s_), [this](const ros::SteadyTimerEvent&) { publish(); });
}

void ControllerTopics::publish() {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const ros::Time published = ros::Time::now();
  if (const std::optional<control::TrackingRow> row = system_.snapshot()) {
    const ros::Time stamp = stampOf(*row, published);
    publishTracking(*row, stamp);
    followPose(*row);
    if (forward_.ok()) publishJoints(*row, stamp);
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      mean_square_[i] += period_s_ / kForceWindow * (row->force_N[i] * row->force_N[i] - mean_square_[i]);
    if (isDue(slow_at_, now, kSlowPeriod)) {
      Margins margins = marginsMessage(robot_, forward_.ok() ? &forward_.pose : nullptr, *row);
      margins.header.stamp = stamp;
      margins_.publish(margins);
      publishForces(*row, stamp);
      publishResidual(stamp);
    }
  }
  const double window = (now - timing_at_).toSec();
  if (isDue(timing_at_, now, kTimingPeriod)) {
    Timing timing = timingMessage(system_.deployment(), timing_before_);
    timing.header.stamp = published;
    timing.window_s = window;
    timing_.publish(timing);
  }
  publishState();
}

/// When it was measured, not when this timer came to it: whoever differentiates needs the former. One that is published
/// again, because nothing was measured since, keeps its stamp. Rows count from the deployment's start.
ros::Time ControllerTopics::stampOf(const control::TrackingRow& row, const ros::Time& now) {
  if (row.time_s == measured_at_s_) return measured_at_;
  const double age_s = std::max(0.0, rt::toSeconds(system_.deployment().now()) - row.time_s);
  measured_at_s_ = row.time_s;
  measured_at_ = now - ros::Duration(age_s);
  return measured_at_;
}

void ControllerTopics::publishTracking(const control::TrackingRow& row, const ros::Time& stamp) {
  Tracking message;
  message.header.stamp = stamp;
  message.sequence = row.sequence;
  message.path_time_s = row.path_time_s;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    message.reference_m[i] = row.reference_m[i];
    message.position_m[i] = row.position_m[i];
    message.error_m[i] = row.reference_m[i] - row.position_m[i];
    message.velocity_m_per_s[i] = row.velocity_m_per_s[i];
    message.command_V[i] = row.command_V[i];
    message.force_N[i] = row.force_N[i];
  }
  tracking_.publish(message);
}

void ControllerTopics::followPose(const control::TrackingRow& row) {
  if (!robot_.mechanism) return;
  const mechanism::Lengths lengths(row.position_m.data());
  if (forward_.ok()) forward_ = mechanism::forwardKinematics(*robot_.mechanism, lengths, forward_.pose);
  if (!forward_.ok()) forward_ = mechanism::forwardKinematicsFromHome(*robot_.mechanism, lengths);
  if (!forward_.ok())
    ROS_WARN_THROTTLE(5.0, "no platform pose belongs to the measured lengths: joint states and pose are not published");
}

void ControllerTopics::publishJoints(const control::TrackingRow& row, const ros::Time& stamp) {
  sensor_msgs::JointState joints = coordinatesMessage(*robot_.mechanism, forward_.pose, row);
  joints.header.stamp = stamp;
  joints_.publish(joints);
  joints = urdfJointsMessage(*robot_.mechanism, forward_.pose);
  joints.header.stamp = stamp;
  urdf_joints_.publish(joints);
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = stamp;
  pose.header.frame_id = kBaseFrame;
  pose.pose = poseMessage(forward_.pose);
  pose_.publish(pose);
}

void ControllerTopics::publishResidual(const ros::Time& stamp) {
  const std::optional<control::Disturbance> disturbance = system_.disturbance();
  if (!disturbance) return;
  Residual message = residualMessage(*disturbance);
  message.header.stamp = stamp;
  residual_.publish(message);
}

void ControllerTopics::publishForces(const control::TrackingRow& row, const ros::Time& stamp) {
  Forces forces;
  forces.header.stamp = stamp;
  forces.window_s = kForceWindow;
  const control::ControlStatus status = system_.status();
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot_.actuators[i];
    forces.force_N[i] = row.force_N[i];
    forces.feedforward_N[i] = row.feedforward_N[i];
    forces.thermal[i] = status.thermal[i];
    forces.rms_N[i] = std::sqrt(mean_square_[i]);
    forces.continuous_limit_N[i] =
        actuator.force_continuous_N > 0.0 ? actuator.force_continuous_N : std::numeric_limits<double>::infinity();
    forces.peak_limit_N[i] = actuator.forceLimit();
  }
  forces_.publish(forces);
}

void ControllerTopics::publishState() {
  const ControllerState message = stateMessage(system_);
  const std::string summary = message.state + '\n' + message.fault + '\n' + message.reference_file + '\n' +
                              message.playing + '\n' + message.patient + '\n' + message.occupancy + '\n' +
                              std::to_string(message.speed_percent) + (message.recording ? "recording" : "") +
                              (message.at_start ? "at start" : "") + std::to_string(message.dropped_rows);
  const ros::SteadyTime now = ros::SteadyTime::now();
  const bool changed = summary != last_state_;
  if (!changed && (now - state_at_).toSec() < kStatePeriod) return;
  if (!message.fault.empty() && changed) ROS_ERROR("%s: %s", message.fault.c_str(), message.cause.c_str());
  last_state_ = summary;
  state_at_ = now;
  state_.publish(message);
}

}  // namespace knee_robot::nodes
