#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::nodes {

/// What opens a machine beside its hardware file.
struct Site {
  std::string shared_memory;                                    ///< of the simulated robot
  std::function<bool()> stop_requested = [] { return false; };  ///< asked while a simulated machine is waited for
};

/// One way to reach the axes: `backend:` of the hardware file. Controller and guardian open the same machine, each on
/// its own handle.
struct Backend {
  const char* name;
  /// It may be started beside this process: wait for it a little.
  bool starts_beside;
  std::unique_ptr<hardware::AxisBus> (*bus)(const control::HardwareFile&, const mechanism::Robot&, const Site&);
  std::unique_ptr<hardware::EmergencyOutputs> (*outputs)(const control::HardwareFile&, const Site&);
  /// What it opens, the same however it was named: two files may name one card in two ways.
  std::string (*identity)(const control::HardwareFile&, const Site&);
};

/// All of them; a new card is a row here and a name in hardware_file.h.
const std::vector<Backend>& backends();

/// Name of the machine that would be opened, for MachineLock and GuardianLink: equal names are one machine, and one
/// machine has one name. InputError when its cards are not there.
std::string machineName(const control::HardwareFile& file, const Site& site);

/// What a guardian knows of outputs and brakes, as a number that is not 0: the file may change after it has read it.
std::uint64_t wiringMark(const control::HardwareFile& file);

/// Empty, or why no controller may drive this machine without a guardian: one `waits` beside it, or cards that keep what
/// they were given last.
std::string whyNotUnguarded(const control::HardwareFile& file, bool waits);

/// The axes of the controller. InputError when the cards are not there, after 10 s for a machine that starts beside
/// this process.
std::unique_ptr<hardware::AxisBus> openBus(const control::HardwareFile& file, const mechanism::Robot& robot,
                                           const Site& site);
/// The same cards a second time: to bring down what a dead controller left on. As openBus().
std::unique_ptr<hardware::EmergencyOutputs> openOutputs(const control::HardwareFile& file, const Site& site);

}  // namespace knee_robot::nodes
