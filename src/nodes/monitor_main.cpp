// monitor: the controller's state, errors and timing as text, for a PC without a display. Refreshes in place on a
// terminal; writes a line a period elsewhere. Needs a running master; listens only.

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <unistd.h>

#include <cstdio>

#include "knee_robot/base/errors.h"
#include "logger_services.h"
#include "loopback.h"
#include "monitor_text.h"
#include "program.h"

namespace {

using namespace knee_robot;

constexpr const char* kHome = "\x1b[H";
constexpr const char* kClearLine = "\x1b[K\n";
constexpr const char* kClearRest = "\x1b[J";

/// Overwrites what is there line by line, so that nothing flickers.
void refresh(const std::vector<std::string>& lines) {
  std::string screen = kHome;
  for (const std::string& line : lines)
    screen += line + kClearLine;
  screen += kClearRest;
  std::fputs(screen.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  nodes::keepToLoopback();
  ros::init(argc, argv, "monitor", ros::init_options::AnonymousName);
  nodes::CommandLine app(
      "Shows the controller's state, errors and timing as text: refreshed in place on a terminal, one line per "
      "period elsewhere. ROS remappings work: rosrun knee_robot monitor __ns:=left",
      "monitor");
  double period_s = 0.5;
  bool once = false, plain = false;
  app.option("--period", period_s, "refresh period, s").within(0.1, 60.0).showDefault();
  app.flag("--once", once, "print everything once and end; exit status 1 when the controller is silent");
  app.flag("--plain", plain, "print one line per period on a terminal, too");
  app.allowExtras();
  return nodes::runProgram(app, argc, argv, [&]() -> int {
    if (!ros::master::check())
      throw InputError("no ROS master answers at " + ros::master::getURI() +
                       "; set ROS_MASTER_URI, or start the robot");
    ros::NodeHandle node;
    nodes::withdrawLoggerList();
    nodes::TextMonitor monitor(node);
    const bool in_place = !plain && !once && ::isatty(STDOUT_FILENO) != 0;
    if (in_place) std::fputs("\x1b[2J", stdout);
    const ros::SteadyTime begin = ros::SteadyTime::now();
    while (ros::ok()) {
      const ros::SteadyTime next = ros::SteadyTime::now() + ros::WallDuration(period_s);
      while (ros::ok() && ros::SteadyTime::now() < next)
        ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
      const bool complete = monitor.isComplete();
      if (once && !complete && (ros::SteadyTime::now() - begin).toSec() < 3.0) continue;
      if (in_place) {
        refresh(monitor.screen());
      } else if (once) {
        for (const std::string& line : monitor.screen())
          std::printf("%s\n", line.c_str());
        return complete ? kExitDone : 1;
      } else {
        std::printf("%s\n", monitor.line().c_str());
        std::fflush(stdout);
      }
    }
    return kExitDone;
  });
}
