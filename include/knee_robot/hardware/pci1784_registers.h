#pragma once

#include <cstdint>

/// Register map of the Advantech PCI-1784, 4-channel 32-bit quadrature counter. Sources: the maker's 2006 GPL driver, a
/// 2011 xPC S-function, a 2019 integrator's code and the manual's page 52; confidence as stated at each line. There is
/// no mainline driver, and this project has never verified any of it on a card.
namespace knee_robot::hardware::pci1784 {

inline constexpr std::uint16_t kVendor = 0x13fe;
inline constexpr std::uint16_t kDevice = 0x1784;

/// Write: mode word of the counter. Read: its latched 32-bit count. High confidence.
constexpr std::uint32_t counter(int channel) noexcept {
  return 4 * static_cast<std::uint32_t>(channel);
}
inline constexpr std::uint32_t kInterrupts = 0x20;  ///< write: enables (bit 31 = all); read: status. High
inline constexpr std::uint32_t kFilterClock =
    0x24;                                        ///< write: 0 = 8 MHz .. 3 = 1 MHz; read: clears the interrupt. High
inline constexpr std::uint32_t kLatch = 0x28;    ///< write: bit n latches counter n, 0x0F all at one instant. High
inline constexpr std::uint32_t kBoardId = 0x28;  ///< read: bits 3..0. High
inline constexpr std::uint32_t kReset = 0x2C;    ///< write: bit n resets counter n. High
inline constexpr std::uint32_t kDigital = 0x30;  ///< write: outputs, bits 0..3 (medium); read: inputs, bits 4..7 (high)
inline constexpr std::uint32_t kOutputMode = 0x32;  ///< digital output mode; 0 = outputs follow kDigital. Medium

/// What a read of a card that does not answer gives (PCI master abort); writes to it succeed and do nothing.
inline constexpr std::uint32_t kNobodyAnswers = 0xFFFFFFFF;

inline constexpr std::uint32_t kAllCounters = 0x0F;
/// Mode words. High confidence for the words; the meaning of the single bits is inferred from them.
inline constexpr std::uint32_t kModeX4 = 0x113;              ///< x4, software latch, reset to 0
inline constexpr std::uint32_t kModeX4Filtered = 0x193;      ///< the same with the input filter
inline constexpr std::uint32_t kModeResetToZero = 0x010;     ///< inferred: reset value 0 instead of 0x80000000
inline constexpr std::uint32_t kModeSoftwareLatch = 0x100;   ///< inferred
inline constexpr std::uint32_t kModeQuadratureMask = 0x003;  ///< inferred: 3 = x4
inline constexpr std::uint32_t kResetValueWithoutZeroBit = 0x80000000u;  ///< inferred

}  // namespace knee_robot::hardware::pci1784
