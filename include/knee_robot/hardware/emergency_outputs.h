#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/hardware/io_status.h"

namespace knee_robot::hardware {

/// A handle to the cards that can do nothing but what its functions say, and remembers nothing. For a guardian
/// beside the controller: it never initialises. Real-time safe.
class EmergencyOutputs {
 public:
  virtual ~EmergencyOutputs() = default;
  /// Brings them down: the holding brakes engage and the drives are disabled, then 0 V. Answers the first failure, which
  /// keeps nothing from being tried. Again, it changes nothing.
  virtual IoStatus down() noexcept = 0;
  /// Writes these digital outputs, then these volts (finite) at once: with the drives' bit alone the holding brakes engage
  /// while the drives give what carries the load until they hold. NotReady: it cannot, and has written nothing (drives on
  /// a bus stop by themselves).
  virtual IoStatus carry(std::uint8_t /*bits*/, const std::array<double, kChannels>& /*volts*/) noexcept {
    return IoStatus::NotReady;
  }
  /// Where the axes are, in counts of their encoders; changes nothing. NotReady: it cannot.
  virtual IoStatus readCounts(std::array<std::int32_t, kChannels>& /*counts*/) noexcept { return IoStatus::NotReady; }
};

}  // namespace knee_robot::hardware
