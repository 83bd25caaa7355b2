#include "knee_robot/simulation/pci1720_model.h"

#include "knee_robot/hardware/pci1720_registers.h"

namespace knee_robot::simulation {
namespace {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::uint16_t>::is_always_lock_free &&
                  std::atomic<std::uint8_t>::is_always_lock_free,
              "images lie in shared memory and are used from real-time threads");

constexpr int kRangeShift = 48;
constexpr std::uint64_t kCodesMask = 0x0000FFFFFFFFFFFFull;
constexpr std::uint64_t kRangeMask = 0xFFull << kRangeShift;

constexpr std::uint64_t codeAt(int channel, std::uint64_t code) {
  return (code & hardware::pci1720::kMaxCode) << (12 * channel);
}

}  // namespace

std::array<double, hardware::kChannels> outputVolts(const Pci1720Image& image) noexcept {
  const std::uint64_t word = image.converters.load(std::memory_order_acquire);
  std::array<double, hardware::kChannels> volts{};
  for (int channel = 0; channel < hardware::kChannels; ++channel) {
    const auto code = static_cast<std::uint16_t>((word >> (12 * channel)) & hardware::pci1720::kMaxCode);
    const auto range = static_cast<unsigned>((word >> (kRangeShift + 2 * channel)) & 3);
    volts[static_cast<std::size_t>(channel)] = hardware::pci1720::toVolts(code, range);
  }
  return volts;
}

hardware::IoStatus Pci1720Model::read8(std::uint32_t offset, std::uint8_t& value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) {
    value = 0xFF;
    return hardware::IoStatus::Ok;
  }
  if (offset < hardware::pci1720::kRange) {
    value = 0;
    return hardware::IoStatus::Ok;
  }
  switch (offset) {
    case hardware::pci1720::kRange:
      value = static_cast<std::uint8_t>((image_.converters.load() & kRangeMask) >> kRangeShift);
      return hardware::IoStatus::Ok;
    case hardware::pci1720::kSynchronousMode:
      value = image_.synchronous.load();
      return hardware::IoStatus::Ok;
    case hardware::pci1720::kBoardId:
      value = image_.board_id.load();
      return hardware::IoStatus::Ok;
    default:
      return hardware::IoStatus::OutOfRange;
  }
}

hardware::IoStatus Pci1720Model::read32(std::uint32_t /*offset*/, std::uint32_t& /*value*/) noexcept {
  return image_.disconnected.load() != 0 ? hardware::IoStatus::Disconnected : hardware::IoStatus::OutOfRange;
}

hardware::IoStatus Pci1720Model::write32(std::uint32_t /*offset*/, std::uint32_t /*value*/) noexcept {
  return image_.disconnected.load() != 0 ? hardware::IoStatus::Disconnected : hardware::IoStatus::OutOfRange;
}

void Pci1720Model::setConverters(std::uint64_t mask, std::uint64_t value) noexcept {
  std::uint64_t old = image_.converters.load(std::memory_order_relaxed);
  while (!image_.converters.compare_exchange_weak(old, (old & ~mask) | value, std::memory_order_acq_rel)) {
    // Only a second process writing the same card in the same nanoseconds brings us back here.
  }
  image_.updates.fetch_add(1, std::memory_order_relaxed);
}

void Pci1720Model::writeData(std::uint32_t offset, std::uint8_t value) noexcept {
  const auto channel = static_cast<std::size_t>(offset / 2);
  if (offset % 2 == 0) {
    image_.low_bytes[channel].store(value);
    return;
  }
  const auto code = static_cast<std::uint16_t>(((value & 0x0F) << 8) | image_.low_bytes[channel].load());
  image_.staged[channel].store(code);
  if ((image_.synchronous.load() & 1) == 0) {
    const int number = static_cast<int>(channel);
    setConverters(codeAt(number, hardware::pci1720::kMaxCode), codeAt(number, code));
  }
}

hardware::IoStatus Pci1720Model::write8(std::uint32_t offset, std::uint8_t value) noexcept {
  if (image_.disconnected.load() == kCardGone) return hardware::IoStatus::Disconnected;
  if (image_.disconnected.load() == kCardSilent) return hardware::IoStatus::Ok;
  if (offset < hardware::pci1720::kRange) {
    writeData(offset, value);
    return hardware::IoStatus::Ok;
  }
  switch (offset) {
    case hardware::pci1720::kRange:
      setConverters(kRangeMask, static_cast<std::uint64_t>(value) << kRangeShift);
      return hardware::IoStatus::Ok;
    case hardware::pci1720::kSynchronise: {
      std::uint64_t codes = 0;
      for (int channel = 0; channel < hardware::kChannels; ++channel) {
        codes |= codeAt(channel, image_.staged[static_cast<std::size_t>(channel)].load());
      }
      setConverters(kCodesMask, codes);
      return hardware::IoStatus::Ok;
    }
    case hardware::pci1720::kSynchronousMode:
      image_.synchronous.store(value & 1);
      return hardware::IoStatus::Ok;
    default:
      return hardware::IoStatus::OutOfRange;
  }
}

}  // namespace knee_robot::simulation
