#include "fault_latch.h"

namespace knee_robot::control {

bool FaultLatch::latch(const FaultCause& cause) noexcept {
  const bool known = cause_.fault == Fault::HoldDeviceSlips || cause_.fault == cause.fault;
  const bool urgent =
      !known && (cause.acute || cause.fault == Fault::HoldDeviceSlips || cause.fault == Fault::MovedWhileOff);
  if (cause.fault == Fault::None || (isLatched() && !urgent)) return false;
  cause_ = cause;
  return true;
}

}  // namespace knee_robot::control
