#include "knee_robot/hardware/pci_emergency_outputs.h"

#include "knee_robot/hardware/pci1720.h"
#include "knee_robot/hardware/pci1720_registers.h"
#include "knee_robot/hardware/pci1784_registers.h"

namespace knee_robot::hardware {

IoStatus outputsPresence(RegisterAccess& counter) noexcept {
  std::uint32_t id = 0;
  const IoStatus status = counter.read32(pci1784::kBoardId, id);
  return status == IoStatus::Ok && id == pci1784::kNobodyAnswers ? IoStatus::Disconnected : status;
}

IoStatus forceDown(RegisterAccess& analog, RegisterAccess& counter) noexcept {
  IoStatus first = IoStatus::Ok;
  const auto note = [&](IoStatus status) {
    if (first == IoStatus::Ok) first = status;
  };
  note(counter.write8(pci1784::kDigital, 0));
  // Codes before the range, as Pci1720::initialise does: on a card that is set up, the range write changes nothing.
  note(analog.write8(pci1720::kSynchronousMode, 1));
  for (int channel = 0; channel < kChannels; ++channel) {
    note(analog.write8(pci1720::lowByte(channel), pci1720::kZeroVoltsCode & 0xFF));
    note(analog.write8(pci1720::highByte(channel), pci1720::kZeroVoltsCode >> 8));
  }
  note(analog.write8(pci1720::kSynchronise, 0));
  note(analog.write8(pci1720::kRange, pci1720::kAllBipolar10V));
  note(outputsPresence(counter));  // last: it changes nothing, and is for the report
  return first;
}

IoStatus forceCarry(RegisterAccess& analog, RegisterAccess& counter, std::uint8_t bits,
                    const std::array<double, kChannels>& volts) noexcept {
  IoStatus first = counter.write8(pci1784::kDigital, bits);
  const auto note = [&](IoStatus status) {
    if (first == IoStatus::Ok) first = status;
  };
  note(analog.write8(pci1720::kSynchronousMode, 1));
  for (int channel = 0; channel < kChannels; ++channel) {
    const std::uint16_t code = Pci1720::codeFor(volts[static_cast<std::size_t>(channel)]);
    note(analog.write8(pci1720::lowByte(channel), code & 0xFF));
    note(analog.write8(pci1720::highByte(channel), code >> 8));
  }
  note(analog.write8(pci1720::kSynchronise, 0));
  note(outputsPresence(counter));
  return first;
}

IoStatus latchedCounts(RegisterAccess& counter, std::array<std::int32_t, kChannels>& counts) noexcept {
  IoStatus status = counter.write32(pci1784::kLatch, pci1784::kAllCounters);
  for (int channel = 0; channel < kChannels && status == IoStatus::Ok; ++channel) {
    std::uint32_t raw = 0;
    status = counter.read32(pci1784::counter(channel), raw);
    counts[static_cast<std::size_t>(channel)] = static_cast<std::int32_t>(raw);
  }
  return status == IoStatus::Ok ? outputsPresence(counter) : status;
}

}  // namespace knee_robot::hardware
