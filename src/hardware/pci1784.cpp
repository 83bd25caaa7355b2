#include "knee_robot/hardware/pci1784.h"

#include "knee_robot/hardware/pci1784_registers.h"
#include "knee_robot/hardware/pci_emergency_outputs.h"

namespace knee_robot::hardware {
namespace {

constexpr std::uint32_t kBoardBits = 0x0F;
constexpr std::int32_t kTremble = 2;  // counts at a standing axis between reset and latch

}  // namespace

Pci1784::Pci1784(RegisterAccess& registers, Options options) : registers_(registers), options_(options) {}

bool Pci1784::disableOutputs(std::vector<std::string>& findings) {
  ready_ = false;
  const auto fail = [&](const std::string& what) {
    findings.push_back("PCI-1784: " + what);
    return false;
  };
  std::uint32_t id = 0;
  const IoStatus presence = registers_.read32(pci1784::kBoardId, id);
  if (presence != IoStatus::Ok) return fail(std::string("board id cannot be read: ") + toText(presence) + ".");
  if (id == pci1784::kNobodyAnswers) return fail("no card answers.");
  board_id_ = id & kBoardBits;
  if (options_.board_id && static_cast<std::uint32_t>(*options_.board_id) != board_id_) {
    return fail("board id " + std::to_string(board_id_) + " instead of " + std::to_string(*options_.board_id) + ".");
  }
  // Outputs off before and after the mode, whichever of the two the card obeyed until now.
  IoStatus status = registers_.write8(pci1784::kDigital, 0);
  if (status == IoStatus::Ok) status = registers_.write8(pci1784::kOutputMode, 0);
  if (status == IoStatus::Ok) status = registers_.write8(pci1784::kDigital, 0);
  if (status == IoStatus::Ok) status = registers_.write32(pci1784::kInterrupts, 0);
  if (status != IoStatus::Ok) return fail(std::string("outputs cannot be switched off: ") + toText(status) + ".");
  findings.push_back("PCI-1784: board " + std::to_string(board_id_) + ", digital outputs off.");
  return true;
}

bool Pci1784::initialiseCounters(std::vector<std::string>& findings) {
  const auto fail = [&](const std::string& what) {
    findings.push_back("PCI-1784: " + what);
    return false;
  };
  const std::uint32_t mode = options_.input_filter ? pci1784::kModeX4Filtered : pci1784::kModeX4;
  IoStatus status = registers_.write32(pci1784::kFilterClock, 0);
  for (int channel = 0; channel < kChannels && status == IoStatus::Ok; ++channel) {
    status = registers_.write32(pci1784::counter(channel), mode);
  }
  if (status == IoStatus::Ok) status = registers_.write32(pci1784::kReset, pci1784::kAllCounters);
  ready_ = true;
  lost_ = false;
  std::array<std::int32_t, kChannels> counts{};
  if (status == IoStatus::Ok) status = readCounts(counts);
  ready_ = false;
  if (status != IoStatus::Ok) return fail(std::string("counters cannot be set up: ") + toText(status) + ".");
  for (std::size_t channel = 0; channel < counts.size(); ++channel) {
    if (counts[channel] < -kTremble || counts[channel] > kTremble) {
      return fail("counter " + std::to_string(channel) + " reads " + std::to_string(counts[channel]) +
                  " after its reset instead of 0: wrong mode word, or the axis moves.");
    }
  }
  findings.push_back("PCI-1784: four counters reset, latched and read back as 0.");
  ready_ = true;
  return true;
}

IoStatus Pci1784::checkPresence() noexcept {
  std::uint32_t id = 0;
  const IoStatus status = registers_.read32(pci1784::kBoardId, id);
  if (status != IoStatus::Ok) return status;
  if (id == pci1784::kNobodyAnswers) return IoStatus::Disconnected;
  return (id & kBoardBits) == board_id_ ? IoStatus::Ok : IoStatus::DeviceError;
}

IoStatus Pci1784::readCounts(std::array<std::int32_t, kChannels>& counts) noexcept {
  if (!ready_) return IoStatus::NotReady;
  if (lost_) return IoStatus::Disconnected;
  IoStatus status = registers_.write32(pci1784::kLatch, pci1784::kAllCounters);
  std::array<std::uint32_t, kChannels> raw{};
  for (int channel = 0; channel < kChannels && status == IoStatus::Ok; ++channel) {
    status = registers_.read32(pci1784::counter(channel), raw[static_cast<std::size_t>(channel)]);
  }
  // All ones would be a plausible count of -1: only the board id tells a lost card.
  if (status == IoStatus::Ok) status = checkPresence();
  lost_ = status != IoStatus::Ok;
  if (lost_) return status;
  for (std::size_t channel = 0; channel < raw.size(); ++channel)
    counts[channel] = static_cast<std::int32_t>(raw[channel]);
  return IoStatus::Ok;
}

IoStatus Pci1784::writeOutputs(std::uint8_t bits) noexcept {
  if (!ready_) return IoStatus::NotReady;
  if (bits > 0x0F) return IoStatus::OutOfRange;
  const IoStatus status = registers_.write8(pci1784::kDigital, bits);
  if (status != IoStatus::Ok) return status;
  return outputsPresence(registers_);  // whoever orders the holding brakes has to know
}

IoStatus Pci1784::readInputs(std::uint8_t& bits) noexcept {
  if (!ready_) return IoStatus::NotReady;
  std::uint8_t value = 0;
  const IoStatus status = registers_.read8(pci1784::kDigital, value);
  if (status != IoStatus::Ok) return status;
  bits = static_cast<std::uint8_t>((value >> 4) & 0x0F);
  return IoStatus::Ok;
}

}  // namespace knee_robot::hardware
