#pragma once

#include <ros/ros.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/guarded_bus.h"
#include "knee_robot/hardware/machine_lock.h"

namespace knee_robot::nodes {

/// The cards, and the guardian between when parameter `guardian` names its shared memory.
struct Machine {
  std::optional<hardware::MachineLock> lock;
  std::unique_ptr<hardware::AxisBus> cards;
  std::optional<hardware::SharedGuardianLink> memory;
  std::unique_ptr<hardware::EmergencyOutputs> outputs;
  std::unique_ptr<hardware::GuardedBus> guarded;

  hardware::AxisBus& bus() { return guarded ? static_cast<hardware::AxisBus&>(*guarded) : *cards; }
};

/// Opens them as hardware file and parameters say. A simulated robot and a guardian that start beside this node are
/// waited for, 10 s at most and not beyond `stop_requested`.
Machine openMachine(const control::HardwareFile& hardware_file, const mechanism::Robot& robot,
                    const ros::NodeHandle& node, const std::function<bool()>& stop_requested);

/// Notices when the guardian's cycle stands still for a second.
class GuardianSupervision {
 public:
  enum class Guardian { None, Acts, Silent };

  explicit GuardianSupervision(Machine& machine) : machine_(machine) {}
  /// To be called often. Says a change on the log.
  Guardian poll();

 private:
  void lookForTheLink(const ros::SteadyTime& now);

  Machine& machine_;
  std::uint64_t cycles_ = 0;
  ros::SteadyTime moved_, looked_;
  bool silent_ = false;
  bool removed_ = false;
};

}  // namespace knee_robot::nodes
