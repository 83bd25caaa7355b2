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

/// Driver of the PCI-1784: four x4 quadrature counters latched by software at one instant, four digital outputs and
/// inputs.
class Pci1784 {
 public:
  /// Board id and input filter.
  struct Options {
    std::optional<int> board_id;  ///< another id at the card is an error; none: any
    bool input_filter = true;     ///< digital filter of the encoder inputs at the 8 MHz clock: inputs up to 2 MHz
  };

  /// `registers` must outlive this.
  Pci1784(RegisterAccess& registers, Options options);

  /// Not real-time. Switches all digital outputs off (drives disabled, brakes on) and the interrupts too. Appends a
  /// sentence to `findings`; false when the card is absent or has the wrong id.
  bool disableOutputs(std::vector<std::string>& findings);
  /// Not real-time, after disableOutputs: sets the counters' mode, resets them and reads 0 back. No motion is needed,
  /// and a tremble of two counts at a standing axis is allowed.
  bool initialiseCounters(std::vector<std::string>& findings);

  /// All three real-time safe. Counts of one instant; `counts` is untouched unless Ok.
  IoStatus readCounts(std::array<std::int32_t, kChannels>& counts) noexcept;
  /// Bits 0 to 3, as are the inputs'.
  IoStatus writeOutputs(std::uint8_t bits) noexcept;
  IoStatus readInputs(std::uint8_t& bits) noexcept;

 private:
  IoStatus checkPresence() noexcept;

  RegisterAccess& registers_;
  Options options_;
  std::uint32_t board_id_ = 0;
  bool ready_ = false;
  bool lost_ = false;  // did not answer since the counters were set up: nobody knows what they count from
};

}  // namespace knee_robot::hardware
