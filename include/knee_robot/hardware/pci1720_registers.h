#pragma once

#include <cstdint>

/// Register map of the Advantech PCI-1720, 4-channel 12-bit analog output. Source: the Linux comedi driver
/// adv_pci1720.c (published GPL source, read whole); high confidence. Never verified on a card by this project.
namespace knee_robot::hardware::pci1720 {

inline constexpr std::uint16_t kVendor = 0x13fe;
inline constexpr std::uint16_t kDevice = 0x1720;

constexpr std::uint32_t lowByte(int channel) noexcept {
  return 0x00 + 2 * static_cast<std::uint32_t>(channel);
}
/// Bits 3..0: code bits 11..8. The low byte is written first.
constexpr std::uint32_t highByte(int channel) noexcept {
  return 0x01 + 2 * static_cast<std::uint32_t>(channel);
}
inline constexpr std::uint32_t kRange = 0x08;            ///< 2 bits a channel; can be read back
inline constexpr std::uint32_t kSynchronise = 0x09;      ///< any write updates all four channels
inline constexpr std::uint32_t kSynchronousMode = 0x0F;  ///< bit 0
inline constexpr std::uint32_t kBoardId = 0x14;          ///< bits 3..0: position of the switch on the card

inline constexpr std::uint8_t kAllBipolar10V = 0xFF;  ///< range 3 on all four channels
inline constexpr std::uint16_t kMaxCode = 0x0FFF;
inline constexpr std::uint16_t kZeroVoltsCode = 0x800;  ///< in a bipolar range; code 0 is the negative end

/// Voltage of a straight binary code in range 0..3 (0..5 V, 0..10 V, +-5 V, +-10 V).
constexpr double toVolts(std::uint16_t code, unsigned range) noexcept {
  const double span = range == 0 ? 5.0 : range == 3 ? 20.0 : 10.0;
  const double lowest = range < 2 ? 0.0 : -span / 2.0;
  return lowest + span * code / 4096.0;
}

}  // namespace knee_robot::hardware::pci1720
