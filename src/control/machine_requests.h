#pragma once

#include <atomic>
#include <optional>

#include "cycle_runner.h"
#include "knee_robot/control/answer.h"
#include "machine_report.h"

namespace knee_robot::control {

/// What ends what a request may have begun; empty: nothing moves by it.
std::optional<RequestKind> endOf(RequestKind kind) noexcept;

/// Asks the Supervisor, and waits for its answer. Several threads may ask at once. Whoever hears that there is no
/// answer can rely on it that nothing begins later: the request expires, and what may have begun is ended.
class MachineRequests {
 public:
  /// All must outlive this.
  MachineRequests(const MachineComponents& machine, const HardwareFile& hardware, OperatorPanel& panel,
                  const MachineReport& report, CycleRunner& runner, const std::atomic<bool>& started)
      : machine_(machine),
        homing_(hardware.homing.method),
        panel_(panel),
        report_(report),
        runner_(runner),
        started_(started) {}

  /// The machine's answer in a sentence; not ok, too, when it does not answer within `timeout_s`.
  Answer make(RequestKind kind, double timeout_s, double value = 0.0);
  /// From now on only what stops the machine is asked for.
  void refuseToMove() { ending_ = true; }

 private:
  rt::Nanoseconds expiry() const noexcept;
  void askAndForget(RequestKind kind);

  const MachineComponents& machine_;
  const HomingMethod homing_;
  OperatorPanel& panel_;
  const MachineReport& report_;
  CycleRunner& runner_;
  const std::atomic<bool>& started_;
  std::atomic<bool> ending_{false};
};

}  // namespace knee_robot::control
