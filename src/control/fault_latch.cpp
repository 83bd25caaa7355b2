#include "knee_robot/control/fault_latch.h"

namespace knee_robot::control {

bool FaultLatch::latch(const FaultCause& cause) noexcept {
  if (cause.fault == Fault::None || isLatched()) return false;
  cause_ = cause;
  return true;
}

}  // namespace knee_robot::control
