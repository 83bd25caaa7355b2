#pragma once

#include <cstdint>

#include "knee_robot/hardware/can/frame.h"

namespace knee_robot::hardware::can {

/// Outcome of sending or receiving one frame.
enum class PortStatus : std::uint8_t {
  Ok,
  Empty,      ///< nothing to receive now
  Full,       ///< the queue takes no more: nobody takes frames off the bus, or something floods it
  Malformed,  ///< something was received that is no CAN frame; it is gone
  Down,       ///< the interface is down or gone, the peer has closed
};

/// Where frames go out and come in. Real-time safe: never blocks, allocates or throws. One thread uses a port at a
/// time.
class FramePort {
 public:
  virtual ~FramePort() = default;
  virtual PortStatus send(const Frame& frame) noexcept = 0;
  /// `frame` is untouched unless Ok.
  virtual PortStatus receive(Frame& frame) noexcept = 0;
  /// Monotonic clock of the frames' time stamps, ns.
  virtual std::int64_t now() noexcept = 0;
  /// Not real-time: lets about so much time pass, for whoever waits for an answer. A bench steps its drives here.
  virtual void pause(std::int64_t duration_ns) = 0;
};

}  // namespace knee_robot::hardware::can
