#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/hardware/register_access.h"
#include "knee_robot/simulation/card_loss.h"

namespace knee_robot::simulation {

/// What a PCI-1784 holds, as plain lock-free atomics (see Pci1720Image). All zero is the card after a cold start.
///
/// The plant publishes the four encoders' running sums in a small ring, so that a latch sees the four of one instant
/// although no lock is taken, and so that a plant that dies while writing leaves the last whole set.
struct Pci1784Image {
  static constexpr std::uint64_t kSlots = 8;

  std::array<std::array<std::atomic<std::uint32_t>, hardware::kChannels>, kSlots>
      live{};                                                             ///< sums since ever, modulo 2^32
  std::atomic<std::uint64_t> published{0};                                ///< the newest is live[published % kSlots]
  std::array<std::atomic<std::uint32_t>, hardware::kChannels> offsets{};  ///< count = live - offset (modulo 2^32)
  std::array<std::atomic<std::uint32_t>, hardware::kChannels> latched{};
  std::array<std::atomic<std::uint32_t>, hardware::kChannels> modes{};
  std::atomic<std::uint32_t> interrupts{0};
  std::atomic<std::uint32_t> filter_clock{0};
  std::atomic<std::uint8_t> outputs{0};  ///< digital outputs, bits 0..3
  std::atomic<std::uint8_t> output_mode{0};
  std::atomic<std::uint8_t> inputs{0};  ///< digital inputs, bits 0..3, set by the plant
  std::atomic<std::uint8_t> board_id{0};
  std::atomic<std::uint8_t> disconnected{0};      ///< CardLoss; outputs hold meanwhile
  std::atomic<std::uint32_t> answer_delay_us{0};  ///< set: a latch takes so long, as on a bus that is held by others
};

/// The plant's side: the four encoders now stand at these running sums (x4 counts, modulo 2^32). One writer.
void publishCounts(Pci1784Image& image, const std::array<std::uint32_t, hardware::kChannels>& sums) noexcept;
/// The newest published sums, all four of one instant.
std::array<std::uint32_t, hardware::kChannels> publishedCounts(const Pci1784Image& image) noexcept;

/// Register-level model of the PCI-1784 over an image: what the sources of pci1784_registers.h say the card does. An
/// offset or width that the register map does not have is OutOfRange. Inferred: a counter without a quadrature mode is
/// not latched, nor is one without the software latch bit. Interrupts, index and overflow flags are not modelled.
class Pci1784Model : public hardware::RegisterAccess {
 public:
  /// `image` must outlive this.
  explicit Pci1784Model(Pci1784Image& image) : image_(image) {}
  hardware::IoStatus read8(std::uint32_t offset, std::uint8_t& value) noexcept override;
  hardware::IoStatus read32(std::uint32_t offset, std::uint32_t& value) noexcept override;
  hardware::IoStatus write8(std::uint32_t offset, std::uint8_t value) noexcept override;
  hardware::IoStatus write32(std::uint32_t offset, std::uint32_t value) noexcept override;

 private:
  void latch(std::uint32_t mask) noexcept;
  void reset(std::uint32_t mask) noexcept;

  Pci1784Image& image_;
};

}  // namespace knee_robot::simulation
