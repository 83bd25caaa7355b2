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
#include "knee_robot/hardware/can/can_axis_bus.h"
#include "knee_robot/hardware/guarded_bus.h"
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

/// A simulated robot starts beside this node: wait for it a little.
template <typename Open>
std::unique_ptr<hardware::AxisBus> waitFor(Open&& open) {
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(10.0);
  while (true) {
    try {
      return open();
    } catch (const InputError&) {
      if (stop_requested || ros::WallTime::now() > give_up) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

std::unique_ptr<hardware::AxisBus> openBus(const HardwareFile& hardware_file, const Robot& robot,
                                           const ros::NodeHandle& node) {
  if (hardware_file.backend == "simulated") {
    const std::string name = requiredParameter(node, "shm");
    return waitFor([&] { return hardware::openSimulatedCards(name); });
  }
  if (hardware_file.can) {
    return waitFor([&] { return hardware::can::openCanDrives(*hardware_file.can, canUnits(robot)); });
  }
  return hardware::openPciCards(std::nullopt, std::nullopt);
}

/// The cards, and the guardian between when parameter `guardian` names its shared memory.
struct Machine {
  std::unique_ptr<hardware::AxisBus> cards;
  std::optional<hardware::SharedGuardianLink> memory;
  std::unique_ptr<hardware::GuardedBus> guarded;

  hardware::AxisBus& bus() { return guarded ? static_cast<hardware::AxisBus&>(*guarded) : *cards; }
};

Machine openMachine(const HardwareFile& hardware_file, const Robot& robot, const ros::NodeHandle& node) {
  Machine machine;
  machine.cards = openBus(hardware_file, robot, node);
  const std::string link = node.param<std::string>("guardian", "");
  if (link.empty()) {
    ROS_WARN("NO GUARDIAN: when this process dies, the drives keep what they were given last");
    return machine;
  }
  machine.memory.emplace(hardware::SharedGuardianLink::open(link));
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(10.0);
  const std::atomic<std::int32_t>& guardian = machine.memory->link().guardian_pid;
  while (!hardware::processExists(guardian.load()) && !stop_requested && ros::WallTime::now() < give_up)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const int power_bits = 1 << hardware_file.drive_enable_bit | 1 << hardware_file.hold_release_bit;
  machine.guarded = std::make_unique<hardware::GuardedBus>(*machine.cards, machine.memory->link(),
                                                           static_cast<std::uint8_t>(power_bits));
  return machine;
}

/// Says once when the guardian's cycle stands still for a second.
class GuardianSupervision {
 public:
  explicit GuardianSupervision(Machine& machine) : machine_(machine) {}
  void look() {
    if (!machine_.memory) return;
    const std::uint64_t cycles = machine_.memory->link().guardian_cycles.load();
    const ros::WallTime now = ros::WallTime::now();
    if (cycles != cycles_ || moved_.isZero()) {
      if (silent_) ROS_WARN("the guardian is back");
      cycles_ = cycles;
      moved_ = now;
      silent_ = false;
    } else if (!silent_ && (now - moved_).toSec() > 1.0) {
      silent_ = true;
      ROS_ERROR("THE GUARDIAN IS SILENT: nothing brings the outputs down when this process dies; disable the robot");
    }
  }

 private:
  Machine& machine_;
  std::uint64_t cycles_ = 0;
  ros::WallTime moved_;
  bool silent_ = false;
};

int run() {
  ros::NodeHandle node("~");
  const Robot robot = loadRobot(requiredParameter(node, "robot"));
  HardwareFile hardware_file = loadHardwareFile(requiredParameter(node, "hardware"));
  if (hardware_file.can) node.param("can", hardware_file.can->interface, hardware_file.can->interface);
  const double rate_hz = node.param("rate_hz", 50.0);
  if (!(rate_hz >= 1.0 && rate_hz <= 500.0)) {
    throw InputError("parameter " + node.resolveName("rate_hz") + " is outside 1 .. 500; it is the rate of the topics");
  }
  const Folder references(requiredParameter(node, "references"));
  const Folder recordings(requiredParameter(node, "recordings"));
  Machine machine = openMachine(hardware_file, robot, node);

  ControlSystem system(robot, hardware_file, requiredParameter(node, "deployment"), machine.bus(), {});
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
    GuardianSupervision guardian(machine);
    while (!stop_requested && ros::ok()) {
      guardian.look();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
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
