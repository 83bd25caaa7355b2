#include "controller_ports.h"

#include <algorithm>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/control/port_values.h"
#include "knee_robot/rt/names.h"

namespace knee_robot::nodes {
namespace {

constexpr double kTapPoll_s = 0.02;     // a tap holds half a second at 1 kHz
constexpr std::uint32_t kQueue = 1000;  // a subscriber that is slower than a second loses the oldest

/// "COMPONENT.PORT" of a port's message or topic.
std::string componentOf(const rt::PortBase& port) {
  return port.fullName().substr(0, port.fullName().find('.'));
}

}  // namespace

rt::PortBase* findWatchablePort(const rt::Deployment& deployment, const std::string& name, std::string& sentence) {
  const std::size_t dot = name.find('.');
  const std::string component_name = name.substr(0, dot), shown = name.substr(0, 60);
  rt::TaskContext* const component = deployment.component(component_name);
  if (dot == std::string::npos || component == nullptr) {
    sentence = "'" + shown + "' is no port: say COMPONENT.PORT with one of the components " +
               rt::listNames(deployment.components());
    return nullptr;
  }
  rt::PortBase* const port = component->port(name.substr(dot + 1));
  if (port == nullptr) {
    sentence = "there is no port " + shown + "; " + component_name + " has " + rt::listNames(component->ports());
    return nullptr;
  }
  if (port->source() == nullptr) {
    sentence = name + " is connected to nothing: nothing comes there";
    return nullptr;
  }
  if (control::portValueNames(port->type()).empty()) {
    sentence =
        name + " carries " + port->typeName() + ", which has no field names yet (see docs/extending.md, A component)";
    return nullptr;
  }
  return port->source();
}

ControllerPorts::ControllerPorts(ros::NodeHandle& node, const control::ControlSystem& system, EventLog& log)
    : node_(node),
      system_(system),
      log_(log),
      server_(node.advertiseService("watch_port", &ControllerPorts::serve, this)),
      timer_(
          node.createSteadyTimer(ros::WallDuration(kTapPoll_s), [this](const ros::SteadyTimerEvent&) { publish(); })) {}

ControllerPorts::~ControllerPorts() {
  timer_.stop();
  for (const Watched& one : watched_)
    one.tap->close();
}

bool ControllerPorts::serve(Call& call) {
  const WatchPort::Request& request = call.getRequest();
  WatchPort::Response& response = call.getResponse();
  std::string sentence;
  rt::PortBase* const port = findWatchablePort(system_.deployment(), request.port, sentence);
  const control::Answer answer = port == nullptr ? control::Answer{false, sentence}
                                 : request.watch ? begin(request, response)
                                                 : end(*port, "as asked");
  response.success = answer.ok;
  response.message = answer.sentence;
  log_.request(call.getCallerName(), std::string(request.watch ? "watch_port " : "watch_port (end) ") + request.port,
               answer);
  return true;
}

std::string ControllerPorts::topicOf(const rt::PortBase& port) const {
  return "ports/" + componentOf(port) + "/" + port.name();
}

std::vector<ControllerPorts::Watched>::iterator ControllerPorts::find(const rt::PortBase& port) {
  return std::find_if(watched_.begin(), watched_.end(), [&](const Watched& one) { return one.port == &port; });
}

control::Answer ControllerPorts::begin(const WatchPort::Request& request, WatchPort::Response& response) {
  if (!(request.rate_hz == 0.0 || (request.rate_hz >= 0.1 && request.rate_hz <= 20000.0)))
    return {false, "rate_hz is 0 for every value or lies between 0.1 and 20000, not " + shortNumber(request.rate_hz)};
  std::string ignored;
  rt::PortBase* const port = findWatchablePort(system_.deployment(), request.port, ignored);
  auto one = find(*port);
  if (one == watched_.end()) {
    if (watched_.size() >= kMost) {
      const std::string others = joined(watched_, [](const Watched& other) { return other.port->fullName(); });
      return {false, std::to_string(kMost) + " ports are watched already; end one of them first: " + others};
    }
    Watched watched{port, port->tap(), node_.advertise<PortValues>(topicOf(*port), kQueue), {}, 0.0, {}, {}};
    watched.message.names = control::portValueNames(port->type());
    watched.tap->open();
    watched_.push_back(std::move(watched));
    one = watched_.end() - 1;
  }
  one->period_s = request.rate_hz > 0.0 ? 1.0 / request.rate_hz : 0.0;
  one->wanted = ros::SteadyTime::now();
  response.topic = one->publisher.getTopic();
  response.names = one->message.names;
  const bool is_input = request.port != port->fullName();
  return {true, request.port + (is_input ? ", which comes from " + port->fullName() + "," : "") + " is published as " +
                    response.topic + " until nobody has subscribed for " + shortNumber(kPatience_s) + " s"};
}

control::Answer ControllerPorts::end(rt::PortBase& port, const std::string& why) {
  const auto one = find(port);
  if (one == watched_.end()) return {false, port.fullName() + " is not watched"};
  one->tap->close();
  watched_.erase(one);
  return {true, port.fullName() + " is not watched any more: " + why};
}

void ControllerPorts::publish() {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const ros::Duration to_ros_time(ros::Time::now().toSec() - rt::toSeconds(rt::monotonicNow()));
  std::vector<rt::PortBase*> unwanted;
  for (Watched& one : watched_) {
    empty(one, to_ros_time);
    if (one.publisher.getNumSubscribers() > 0) one.wanted = now;
    if ((now - one.wanted).toSec() > kPatience_s) unwanted.push_back(one.port);
  }
  for (rt::PortBase* port : unwanted)
    log_.add("controller", "", end(*port, "nobody listened").sentence);
}

void ControllerPorts::empty(Watched& one, const ros::Duration& to_ros_time) {
  rt::Nanoseconds written_at = 0;
  while (const void* value = one.tap->next(written_at)) {
    ros::Time stamp;
    stamp.fromSec(rt::toSeconds(written_at) + to_ros_time.toSec());
    // Half a cycle's grace: at 500 Hz every second value of 1 kHz, however the writer's jitter falls.
    if (one.period_s > 0.0 && (stamp - one.published).toSec() < one.period_s - 0.0005) continue;
    one.published = stamp;
    one.message.header.stamp = stamp;
    one.message.lost = one.tap->lost();
    control::portValues(one.port->type(), value, one.message.value);
    one.publisher.publish(one.message);
  }
}

}  // namespace knee_robot::nodes
