// ROS node `monitor_markers`: what rviz shows beside the robot model, from the controller's topics. Any number of them
// may run, on any machine; none is needed by the controller.
//
//     parameters    ~robot     robot file
//                   ~rate_hz   of the markers, 15
//     subscribes    controller/{state, tracking, margins, residual, path}
//     publishes     markers    visualization_msgs/MarkerArray; see monitor_scene.h
//     tf            base -> platform_reference   pose that belongs to the reference lengths

#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include "controller_machine.h"
#include "controller_pose.h"
#include "knee_robot/base/errors.h"
#include "logger_services.h"
#include "loopback.h"
#include "monitor_scene.h"
#include "parameters.h"
#include "program.h"

namespace {

using namespace knee_robot;

constexpr double kSilence_s = 2.0;

class MarkerMonitor {
 public:
  MarkerMonitor(ros::NodeHandle& node, const mechanism::Robot& robot, double rate_hz)
      : robot_(robot),
        controller_(node.resolveName("controller")),
        markers_(node.advertise<visualization_msgs::MarkerArray>("markers", 2)),
        subscribers_{node.subscribe<ControllerState>(controller_ + "/state", 2,
                                                     [this](const auto& message) { hear(heard_.state, *message); }),
                     node.subscribe<Tracking>(controller_ + "/tracking", 2,
                                              [this](const auto& message) { hear(heard_.tracking, *message); }),
                     node.subscribe<Margins>(controller_ + "/margins", 2,
                                             [this](const auto& message) { hear(heard_.margins, *message); }),
                     node.subscribe<Residual>(controller_ + "/residual", 2,
                                              [this](const auto& message) { hear(heard_.residual, *message); }),
                     node.subscribe<nav_msgs::Path>(controller_ + "/path", 2,
                                                    [this](const auto& message) { hear(heard_.path, *message); })},
        timer_(node.createSteadyTimer(ros::WallDuration(1.0 / rate_hz), [this](const auto&) { show(); })) {}

 private:
  template <typename Message>
  void hear(std::optional<Message>& kept, const Message& message) {
    kept = message;
    heard_at_ = ros::SteadyTime::now();
  }

  void show() {
    heard_.silent = (ros::SteadyTime::now() - heard_at_).toSec() > kSilence_s;
    followReference();
    markers_.publish(nodes::sceneOf(robot_, heard_));
    if (!heard_.reference) return;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time::now();
    transform.header.frame_id = nodes::kBaseFrame;
    transform.child_frame_id = "platform_reference";
    const geometry_msgs::Pose pose = nodes::poseMessage(*heard_.reference);
    transform.transform.translation.x = pose.position.x;
    transform.transform.translation.y = pose.position.y;
    transform.transform.translation.z = pose.position.z;
    transform.transform.rotation = pose.orientation;
    broadcaster_.sendTransform(transform);
  }

  void followReference() {
    if (!robot_.mechanism || !heard_.tracking) return;
    const mechanism::Lengths lengths(heard_.tracking->reference_m.data());
    if (forward_.ok()) forward_ = mechanism::forwardKinematics(*robot_.mechanism, lengths, forward_.pose);
    if (!forward_.ok()) forward_ = mechanism::forwardKinematicsFromHome(*robot_.mechanism, lengths);
    heard_.reference.reset();
    if (forward_.ok()) heard_.reference = forward_.pose;
  }

  const mechanism::Robot& robot_;
  const std::string controller_;
  nodes::Heard heard_;
  ros::SteadyTime heard_at_;
  mechanism::ForwardResult forward_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Publisher markers_;
  std::array<ros::Subscriber, 5> subscribers_;
  ros::SteadyTimer timer_;
};

}  // namespace

int main(int argc, char** argv) {
  nodes::keepToLoopback();
  ros::init(argc, argv, "monitor_markers");
  nodes::CommandLine app("Shows rviz the reference pose, the path to come, tracking errors and margins. A ROS node.",
                         "monitor_markers");
  app.serves();
  app.footer("Parameters: ~robot (robot file), ~rate_hz (1 .. 60, default 15)");
  return nodes::runProgram(app, argc, argv, [] {
    ros::NodeHandle own("~"), node;
    nodes::withdrawLoggerList();
    const mechanism::Robot robot = mechanism::loadRobot(nodes::requiredParameter(own, "robot"));
    const double rate_hz = nodes::numberParameter(own, "rate_hz", 15.0, 1.0, 60.0, "the rate of the markers");
    MarkerMonitor monitor(node, robot, rate_hz);
    ros::spin();
    return kExitDone;
  });
}
