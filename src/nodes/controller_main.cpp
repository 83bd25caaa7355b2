// ROS node `controller`: Sync, four Drivers and their supervision on the cards or on the simulated robot. Parameters: see
// launch/simulation.launch. SIGINT, SIGTERM and the loss of the master end in the safe stop.

#include <ros/ros.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "controller_services.h"
#include "controller_topics.h"
#include "folder.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/hardware/open_bus.h"

namespace {

using namespace knee_robot;

volatile std::sig_atomic_t stop_requested = 0;

std::string requiredParameter(const ros::NodeHandle& node, const std::string& name) {
  std::string value;
  if (!node.getParam(name, value) || value.empty()) {
    throw InputError("parameter " + node.resolveName(name) + " is missing; launch/simulation.launch shows all of them");
  }
  return value;
}

/// The simulated robot starts beside this node: wait for it a little.
std::unique_ptr<hardware::AxisBus> waitForSimulatedCards(const std::string& name) {
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(10.0);
  while (true) {
    try {
      return hardware::openSimulatedCards(name);
    } catch (const InputError&) {
      if (stop_requested || ros::WallTime::now() > give_up) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

std::unique_ptr<hardware::AxisBus> openBus(const HardwareFile& hardware_file, const ros::NodeHandle& node) {
  if (hardware_file.backend == "simulated") return waitForSimulatedCards(requiredParameter(node, "shm"));
  return hardware::openPciCards(std::nullopt, std::nullopt);
}

int run() {
  ros::NodeHandle node("~");
  const Robot robot = loadRobot(requiredParameter(node, "robot"));
  const HardwareFile hardware_file = loadHardwareFile(requiredParameter(node, "hardware"));
  const double rate_hz = node.param("rate_hz", 50.0);
  if (!(rate_hz >= 1.0 && rate_hz <= 500.0)) {
    throw InputError("parameter " + node.resolveName("rate_hz") + " is outside 1 .. 500; it is the rate of the topics");
  }
  const Folder references(requiredParameter(node, "references"));
  const Folder recordings(requiredParameter(node, "recordings"));
  const std::unique_ptr<hardware::AxisBus> bus = openBus(hardware_file, node);

  ControlSystem system(robot, hardware_file, requiredParameter(node, "deployment"), *bus, {});
  const Answer started = system.start();
  if (!started.ok) throw InputError(started.sentence);
  for (const std::string& warning : system.warnings())
    ROS_WARN("NOT REAL TIME: %s", warning.c_str());
  ROS_INFO("%s", started.sentence.c_str());
  {
    ControllerServices services(node, system, robot, references, recordings);
    ControllerTopics topics(node, system, robot, rate_hz);
    ros::AsyncSpinner spinner(3);
    spinner.start();
    while (!stop_requested && ros::ok())
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const Answer stopped = system.shutdown();
  std::printf("controller: %s\n", stopped.sentence.c_str());
  return stopped.ok ? kExitDone : 1;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "controller", ros::init_options::NoSigintHandler);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int) { stop_requested = 1; });
  try {
    return run();
  } catch (const InputError& error) {
    std::fprintf(stderr, "controller: %s\n", error.what());
    return kExitBadInput;
  }
}
