#include "controller_machine.h"

#include <chrono>
#include <thread>

#include "backends.h"
#include "knee_robot/base/errors.h"
#include "parameters.h"

namespace knee_robot::nodes {
namespace {

constexpr double kStatePatience_s = 10.0;  // s

}  // namespace

Machine openMachine(const control::HardwareFile& hardware_file, const mechanism::Robot& robot,
                    const ros::NodeHandle& node, const std::function<bool()>& stop_requested) {
  Machine machine;
  const bool simulated = hardware_file.backend == "simulated";
  const Site site{
      simulated ? requiredParameter(node, "shm") : textParameter(node, "shm", "", "the name of a shared memory"),
      stop_requested};
  const std::string name = machineName(hardware_file, site);
  machine.lock.emplace(hardware::MachineLock::take("controller", name));
  machine.cards = openBus(hardware_file, robot, site);
  const std::string link = textParameter(node, "guardian", "", "the name of the shared memory with the guardian");
  if (link.empty()) {
    if (const std::string why = whyNotUnguarded(hardware_file, hardware::MachineLock::isTaken("guardian", name));
        !why.empty())
      throw InputError(why);
    ROS_WARN("NO GUARDIAN: when this process dies, the drives keep what they were given last");
    return machine;
  }
  machine.memory.emplace(hardware::SharedGuardianLink::open(link));
  const int power_bits = 1 << hardware_file.drive_enable_bit | 1 << hardware_file.hold_release_bit;
  machine.outputs = openOutputs(hardware_file, site);
  hardware::GuardedBus::Options options;
  options.outputs = machine.outputs.get();
  options.machine = hardware::machineMark(name);
  options.wiring = wiringMark(hardware_file);
  const double silent_ms = numberParameter(node, "silent_guardian_ms", 50.0, 5.0, 10000.0,
                                           "the silence in ms after which the guardian counts as dead");
  options.guardian_silence_ns = static_cast<std::int64_t>(silent_ms * 1e6);
  machine.guarded = std::make_unique<hardware::GuardedBus>(*machine.cards, machine.memory->link(),
                                                           static_cast<std::uint8_t>(power_bits), options);
  machine.guarded->takeOver();  // the self test says why not
  const ros::SteadyTime give_up = ros::SteadyTime::now() + ros::WallDuration(kStatePatience_s);
  const std::atomic<std::int32_t>& guardian = machine.memory->link().guardian_pid;
  while (!hardware::processExists(guardian.load()) && !stop_requested() && ros::SteadyTime::now() < give_up)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return machine;
}

void GuardianSupervision::lookForTheLink(const ros::SteadyTime& now) {
  if (removed_ || (now - looked_).toSec() < 1.0) return;
  looked_ = now;
  removed_ = !machine_.memory->isNamed();
  if (!removed_) return;
  ROS_ERROR(
      "SOMEBODY HAS REMOVED THE LINK WITH THE GUARDIAN (%s in /dev/shm): one of the two that is started again will not "
      "find the other; disable the robot, end both, and start both",
      machine_.memory->name().c_str());
}

GuardianSupervision::Guardian GuardianSupervision::poll() {
  if (!machine_.memory) return Guardian::None;
  const std::uint64_t cycles = machine_.memory->link().guardian_cycles.load();
  const ros::SteadyTime now = ros::SteadyTime::now();
  lookForTheLink(now);
  if (cycles != cycles_ || moved_.isZero()) {
    if (silent_) ROS_WARN("the guardian is back");
    cycles_ = cycles;
    moved_ = now;
    silent_ = false;
  } else if (!silent_ && (now - moved_).toSec() > 1.0) {
    silent_ = true;
    ROS_ERROR("THE GUARDIAN IS SILENT: nothing brings the outputs down when this process dies; disable the robot");
  }
  return silent_ ? Guardian::Silent : Guardian::Acts;
}

}  // namespace knee_robot::nodes
