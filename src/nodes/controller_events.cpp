#include "controller_events.h"

#include "terminal.h"

namespace knee_robot::nodes {
namespace {

constexpr double kPoll_s = 0.02;

Event toMessage(const LoggedEvent& event) {
  Event message;
  message.header.stamp.fromSec(event.time_s);
  message.number = event.number;
  message.kind = event.kind;
  message.who = event.who;
  message.what = event.what;
  message.answer = event.answer;
  return message;
}

}  // namespace

std::string callerOfGoal(const std::string& goal_id) {
  const std::size_t time = goal_id.rfind('-');
  if (time == std::string::npos || time == 0) return goal_id;
  const std::size_t count = goal_id.rfind('-', time - 1);
  return goal_id.substr(0, count == std::string::npos ? time : count);
}

ControllerEvents::ControllerEvents(ros::NodeHandle& node, const control::ControlSystem& system, EventLog& log)
    : system_(system),
      log_(log),
      publisher_(node.advertise<Event>("events", 200, true)),
      get_(node.advertiseService("get_events", &ControllerEvents::get, this)),
      timer_(node.createWallTimer(ros::WallDuration(kPoll_s), [this](const ros::WallTimerEvent&) { poll(); })) {
  log_.setListener([this](const LoggedEvent& event) { publish(event); });
}

void ControllerEvents::publish(const LoggedEvent& event) {
  publisher_.publish(toMessage(event));
  if (event.kind == "log")
    showOutcome("event log", {false, event.what + (event.answer.empty() ? "" : ": ") + event.answer});
}

void ControllerEvents::poll() {
  const control::ControlStatus status = system_.status();
  const std::string now = std::string(control::toString(status.state)) + '\n' + status.fault_name;
  if (now == last_) return;
  const bool is_new_fault = !status.fault_name.empty() && last_.substr(last_.find('\n') + 1) != status.fault_name;
  const bool is_new_state = last_.substr(0, last_.find('\n')) != control::toString(status.state);
  last_ = now;
  if (is_new_fault) log_.add("fault", "", status.fault_name, status.fault_sentence);
  if (is_new_state) log_.add("state", "", control::toString(status.state));
}

bool ControllerEvents::get(GetEvents::Request& request, GetEvents::Response& response) {
  for (const LoggedEvent& event : log_.after(request.after))
    response.events.push_back(toMessage(event));
  return true;
}

}  // namespace knee_robot::nodes
