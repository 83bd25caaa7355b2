#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/hardware/io_status.h"
#include "knee_robot/hardware/register_access.h"

namespace knee_robot::hardware {

/// Driver of the PCI-1720 in its +-10 V range and synchronous mode: codes are staged channel by channel, one more write
/// moves all four outputs at once. A command that fails before that write leaves all outputs as they were.
class Pci1720 {
 public:
  /// `registers` must outlive this. With a board id, another id at the card is an error.
  explicit Pci1720(RegisterAccess& registers, std::optional<int> board_id = std::nullopt);

  /// Not real-time. Brings all outputs to 0 V in the +-10 V range; call it with the drives disabled. Appends a sentence
  /// a step to `findings`; false when the card is absent or answers wrongly.
  ///
  /// Order, because a cold card stands at code 0 in the 0..5 V range and code 0 is -10 V in the +-10 V range: codes for
  /// 0 V first, then the range. For the microsecond between, a cold card gives +2.5 V (never -10 V) and a warm one
  /// moves straight from what it held to 0 V.
  bool initialise(std::vector<std::string>& findings);

  /// As AxisBus::writeVolts. Real-time safe.
  IoStatus writeVolts(const std::array<double, kChannels>& volts, std::array<double, kChannels>& written) noexcept;

  /// Code for `volts` (finite) in the +-10 V range, clamped and rounded to the nearest step of 20 V / 4096.
  static std::uint16_t codeFor(double volts) noexcept;

 private:
  IoStatus stage(const std::array<std::uint16_t, kChannels>& codes) noexcept;
  IoStatus checkPresence() noexcept;

  RegisterAccess& registers_;
  std::optional<int> wanted_board_id_;
  std::uint8_t board_id_ = 0;
  bool ready_ = false;
};

}  // namespace knee_robot::hardware
