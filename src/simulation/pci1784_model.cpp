#include "knee_robot/simulation/pci1784_model.h"

#include <chrono>

#include "knee_robot/hardware/pci1784_registers.h"

namespace knee_robot::simulation {
namespace {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free && std::atomic<std::uint64_t>::is_always_lock_free,
              "images lie in shared memory and are used from real-time threads");

constexpr std::uint32_t kCounterRegisters = 0x10;

/// Channel of a counter register, or -1.
constexpr int channelAt(std::uint32_t offset) {
  return offset < kCounterRegisters && offset % 4 == 0 ? static_cast<int>(offset / 4) : -1;
}

}  // namespace

void publishCounts(Pci1784Image& image, const std::array<std::uint32_t, hardware::kChannels>& sums) noexcept {
  const std::uint64_t next = image.published.load(std::memory_order_relaxed) + 1;
  auto& slot = image.live[next % Pci1784Image::kSlots];
  for (std::size_t channel = 0; channel < sums.size(); ++channel)
    slot[channel].store(sums[channel]);
  image.published.store(next, std::memory_order_release);
}

std::array<std::uint32_t, hardware::kChannels> publishedCounts(const Pci1784Image& image) noexcept {
  std::array<std::uint32_t, hardware::kChannels> sums{};
  // A set is overwritten only kSlots - 1 publications later; whoever was interrupted for that long reads again,
  // boundedly.
  for (int attempt = 0; attempt < 4; ++attempt) {
    const std::uint64_t newest = image.published.load(std::memory_order_acquire);
    const auto& slot = image.live[newest % Pci1784Image::kSlots];
    for (std::size_t channel = 0; channel < sums.size(); ++channel)
      sums[channel] = slot[channel].load();
    if (image.published.load() - newest < Pci1784Image::kSlots - 1) break;
  }
  return sums;
}

void Pci1784Model::latch(std::uint32_t mask) noexcept {
  if (const std::uint32_t delay_us = image_.answer_delay_us.load(std::memory_order_relaxed); delay_us != 0) {
    // The processor waits for the bus: a busy loop, not a sleep.
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(delay_us);
    while (std::chrono::steady_clock::now() < end) {
    }
  }
  const auto sums = publishedCounts(image_);
  for (std::size_t channel = 0; channel < sums.size(); ++channel) {
    const std::uint32_t mode = image_.modes[channel].load();
    const bool counts =
        (mode & hardware::pci1784::kModeQuadratureMask) != 0 && (mode & hardware::pci1784::kModeSoftwareLatch) != 0;
    if ((mask >> channel & 1) != 0 && counts)
      image_.latched[channel].store(sums[channel] - image_.offsets[channel].load());
  }
}

void Pci1784Model::reset(std::uint32_t mask) noexcept {
  const auto sums = publishedCounts(image_);
  for (std::size_t channel = 0; channel < sums.size(); ++channel) {
    if ((mask >> channel & 1) == 0) continue;
    const bool to_zero = (image_.modes[channel].load() & hardware::pci1784::kModeResetToZero) != 0;
    image_.offsets[channel].store(sums[channel] - (to_zero ? 0u : hardware::pci1784::kResetValueWithoutZeroBit));
  }
}

hardware::IoStatus Pci1784Model::read8(std::uint32_t offset, std::uint8_t& value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) {
    value = 0xFF;
    return hardware::IoStatus::Ok;
  }
  if (offset != hardware::pci1784::kDigital) return hardware::IoStatus::OutOfRange;
  value = static_cast<std::uint8_t>((image_.inputs.load() & 0x0F) << 4);
  return hardware::IoStatus::Ok;
}

hardware::IoStatus Pci1784Model::read32(std::uint32_t offset, std::uint32_t& value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) {
    value = 0xFFFFFFFF;
    return hardware::IoStatus::Ok;
  }
  if (const int channel = channelAt(offset); channel >= 0) {
    value = image_.latched[static_cast<std::size_t>(channel)].load();
    return hardware::IoStatus::Ok;
  }
  if (offset != hardware::pci1784::kBoardId) return hardware::IoStatus::OutOfRange;
  value = image_.board_id.load();
  return hardware::IoStatus::Ok;
}

hardware::IoStatus Pci1784Model::write8(std::uint32_t offset, std::uint8_t value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) return hardware::IoStatus::Ok;
  switch (offset) {
    case hardware::pci1784::kDigital:
      image_.outputs.store(value & 0x0F);
      return hardware::IoStatus::Ok;
    case hardware::pci1784::kOutputMode:
      image_.output_mode.store(value);
      return hardware::IoStatus::Ok;
    default:
      return hardware::IoStatus::OutOfRange;
  }
}

hardware::IoStatus Pci1784Model::write32(std::uint32_t offset, std::uint32_t value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) return hardware::IoStatus::Ok;
  if (const int channel = channelAt(offset); channel >= 0) {
    image_.modes[static_cast<std::size_t>(channel)].store(value);
    return hardware::IoStatus::Ok;
  }
  switch (offset) {
    case hardware::pci1784::kInterrupts:
      image_.interrupts.store(value);
      return hardware::IoStatus::Ok;
    case hardware::pci1784::kFilterClock:
      image_.filter_clock.store(value);
      return hardware::IoStatus::Ok;
    case hardware::pci1784::kLatch:
      latch(value);
      return hardware::IoStatus::Ok;
    case hardware::pci1784::kReset:
      reset(value);
      return hardware::IoStatus::Ok;
    default:
      return hardware::IoStatus::OutOfRange;
  }
}

}  // namespace knee_robot::simulation
