#pragma once

#include <atomic>

#include "knee_robot/control/control_status.h"
#include "knee_robot/hardware/axis_bus.h"
#include "operator_panel.h"

namespace knee_robot::control {

/// What the Supervisor says, in the operator's words; and in place of one that failed or hangs, that it did.
class MachineReport {
 public:
  /// All must outlive this. `started`: the components have been started.
  MachineReport(const rt::Deployment& deployment, const MachineComponents& machine, const OperatorPanel& panel,
                const hardware::AxisBus& bus, const std::atomic<bool>& started)
      : deployment_(deployment), machine_(machine), panel_(panel), bus_(bus), started_(started) {}

  MachineState state() const { return supervisor().state; }
  /// Fills in state, fault, path, speed, homing, guiding, heat.
  void fill(ControlStatus& status) const;
  /// The fault's cause, place and remedy; empty without fault.
  std::string faultSentence() const { return sentenceOfFault(supervisor()); }

 private:
  SupervisorStatus supervisor() const;
  SupervisorStatus ownWord() const;
  std::string sentenceOfFault(const SupervisorStatus& supervisor) const;

  const rt::Deployment& deployment_;
  const MachineComponents& machine_;
  const OperatorPanel& panel_;
  const hardware::AxisBus& bus_;
  const std::atomic<bool>& started_;
};

}  // namespace knee_robot::control
