#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/hardware/register_access.h"
#include "knee_robot/simulation/card_loss.h"

namespace knee_robot::simulation {

/// What a PCI-1720 holds, as plain lock-free atomics: may lie in shared memory and outlives every process that uses it,
/// as the card does. All zero is the card after a cold start: codes 0 in the 0..5 V range.
struct Pci1720Image {
  /// What the four converters give now, in one word, so that an observer never sees half an update: bits 12c+11..12c
  /// the code of channel c, bits 55..48 the range register.
  std::atomic<std::uint64_t> converters{0};
  std::array<std::atomic<std::uint16_t>, hardware::kChannels> staged{};  ///< codes written but not yet updated
  std::array<std::atomic<std::uint8_t>, hardware::kChannels> low_bytes{};
  std::atomic<std::uint8_t> synchronous{0};
  std::atomic<std::uint8_t> board_id{0};
  std::atomic<std::uint8_t> disconnected{0};  ///< CardLoss; outputs hold meanwhile
  std::atomic<std::uint64_t> updates{0};      ///< how often the outputs were updated
};

/// Output voltages of the four channels at one instant.
std::array<double, hardware::kChannels> outputVolts(const Pci1720Image& image) noexcept;

/// Register-level model of the PCI-1720 over an image: what the source of pci1720_registers.h says the card does. An
/// offset or width that the register map does not have is OutOfRange, so that no driver comes to rely on it. Inferred:
/// outside the synchronous mode an output follows when its high byte is written; data registers read as 0.
class Pci1720Model : public hardware::RegisterAccess {
 public:
  /// `image` must outlive this.
  explicit Pci1720Model(Pci1720Image& image) : image_(image) {}
  hardware::IoStatus read8(std::uint32_t offset, std::uint8_t& value) noexcept override;
  hardware::IoStatus read32(std::uint32_t offset, std::uint32_t& value) noexcept override;
  hardware::IoStatus write8(std::uint32_t offset, std::uint8_t value) noexcept override;
  hardware::IoStatus write32(std::uint32_t offset, std::uint32_t value) noexcept override;

 private:
  void setConverters(std::uint64_t mask, std::uint64_t value) noexcept;
  void writeData(std::uint32_t offset, std::uint8_t value) noexcept;

  Pci1720Image& image_;
};

}  // namespace knee_robot::simulation
