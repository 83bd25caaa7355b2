#pragma once

#include <knee_robot/PortValues.h>
#include <knee_robot/WatchPort.h>
#include <ros/ros.h>

#include <memory>
#include <string>
#include <vector>

#include "event_log.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/rt/port.h"

namespace knee_robot::nodes {

/// Any port of any component as a topic, on demand: ~watch_port begins and ends ~ports/COMPONENT/PORT (PortValues). The
/// writer of the port fills a tap without waiting (rt/tap.h); a timer of an ordinary thread empties it. At most kMost
/// at once; one that nobody has subscribed to for kPatience_s ends by itself.
class ControllerPorts {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr double kPatience_s = 10.0;

  /// `node`: the private namespace; one thread serves its callback queue, which carries the service and the timer.
  ControllerPorts(ros::NodeHandle& node, const control::ControlSystem& system, EventLog& log);
  ~ControllerPorts();

 private:
  struct Watched {
    rt::PortBase* port;
    rt::TapBase* tap;
    ros::Publisher publisher;
    PortValues message;
    double period_s = 0.0;   // at least between two messages
    ros::Time published;     // stamp of the newest
    ros::SteadyTime wanted;  // when somebody was seen to listen
  };
  using Call = ros::ServiceEvent<WatchPort::Request, WatchPort::Response>;

  bool serve(Call& call);
  control::Answer begin(const WatchPort::Request& request, WatchPort::Response& response);
  control::Answer end(rt::PortBase& port, const std::string& why);
  std::vector<Watched>::iterator find(const rt::PortBase& port);
  std::string topicOf(const rt::PortBase& port) const;
  void publish();
  void empty(Watched& one, const ros::Duration& to_ros_time);

  ros::NodeHandle& node_;
  const control::ControlSystem& system_;
  EventLog& log_;
  std::vector<Watched> watched_;
  ros::ServiceServer server_;
  ros::SteadyTimer timer_;  // last: goes first
};

/// The output behind COMPONENT.PORT; null, and the sentence says what there is.
rt::PortBase* findWatchablePort(const rt::Deployment& deployment, const std::string& name, std::string& sentence);

}  // namespace knee_robot::nodes
