#pragma once

#include "machine_requests.h"

namespace knee_robot::control {

constexpr double kSafeStop_s = 8.0;  ///< longest deceleration, settling, hold and disable delays together

/// The way back from a fault: outputs that a guardian has taken, components that failed, drives, and then the latch of
/// the Supervisor.
class FaultRecovery {
 public:
  /// All must outlive this.
  FaultRecovery(const rt::Deployment& deployment, hardware::AxisBus& bus, const MachineReport& report,
                MachineRequests& requests, CycleRunner& runner)
      : deployment_(deployment), bus_(bus), report_(report), requests_(requests), runner_(runner) {}

  /// Ends in Disabled, or says what is in the way.
  Answer reset();

 private:
  const rt::Deployment& deployment_;
  hardware::AxisBus& bus_;
  const MachineReport& report_;
  MachineRequests& requests_;
  CycleRunner& runner_;
};

}  // namespace knee_robot::control
