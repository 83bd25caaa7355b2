#include "knee_robot/hardware/pci1720.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/hardware/pci1720_registers.h"

namespace knee_robot::hardware {
namespace {

constexpr unsigned kBipolar10V = 3;
/// A register that no card answers for reads as all ones (PCI master abort).
constexpr std::uint8_t kNobodyThere = 0xFF;
constexpr std::uint8_t kBoardIdMask = 0x0F;

}  // namespace

Pci1720::Pci1720(RegisterAccess& registers, std::optional<int> board_id)
    : registers_(registers), wanted_board_id_(board_id) {}

std::uint16_t Pci1720::codeFor(double volts) noexcept {
  const double code = std::round(volts * (4096.0 / 20.0)) + pci1720::kZeroVoltsCode;
  return static_cast<std::uint16_t>(std::clamp(code, 0.0, static_cast<double>(pci1720::kMaxCode)));
}

bool Pci1720::initialise(std::vector<std::string>& findings) {
  ready_ = false;
  const auto fail = [&](const std::string& what) {
    findings.push_back("PCI-1720: " + what);
    return false;
  };
  std::uint8_t id = 0;
  const IoStatus presence = registers_.read8(pci1720::kBoardId, id);
  if (presence != IoStatus::Ok) return fail(std::string("board id cannot be read: ") + toText(presence) + ".");
  if (id == kNobodyThere) return fail("no card answers.");
  board_id_ = id & kBoardIdMask;
  if (wanted_board_id_ && *wanted_board_id_ != board_id_) {
    return fail("board id " + std::to_string(board_id_) + " instead of " + std::to_string(*wanted_board_id_) + ".");
  }
  std::array<std::uint16_t, kChannels> zero{};
  zero.fill(pci1720::kZeroVoltsCode);
  std::uint8_t mode = 0;
  std::uint8_t range = 0;
  IoStatus status = registers_.write8(pci1720::kSynchronousMode, 1);
  if (status == IoStatus::Ok) status = stage(zero);
  if (status == IoStatus::Ok) status = registers_.write8(pci1720::kSynchronise, 0);
  if (status == IoStatus::Ok) status = registers_.write8(pci1720::kRange, pci1720::kAllBipolar10V);
  if (status == IoStatus::Ok) status = registers_.read8(pci1720::kRange, range);
  if (status == IoStatus::Ok) status = registers_.read8(pci1720::kSynchronousMode, mode);
  if (status != IoStatus::Ok) return fail(std::string("initialisation failed: ") + toText(status) + ".");
  if (range != pci1720::kAllBipolar10V) return fail("the range register does not read back as +-10 V on all channels.");
  findings.push_back("PCI-1720: board " + std::to_string(board_id_) + ", +-10 V on four channels, 0 V.");
  // The driver that is the source never reads this register, so a card that does not return it is not refused.
  if ((mode & 1) == 0) findings.push_back("PCI-1720: note: synchronous mode does not read back.");
  ready_ = true;
  return true;
}

IoStatus Pci1720::stage(const std::array<std::uint16_t, kChannels>& codes) noexcept {
  for (int channel = 0; channel < kChannels; ++channel) {
    const std::uint16_t code = codes[static_cast<std::size_t>(channel)];
    IoStatus status = registers_.write8(pci1720::lowByte(channel), static_cast<std::uint8_t>(code & 0xFF));
    if (status == IoStatus::Ok) {
      status = registers_.write8(pci1720::highByte(channel), static_cast<std::uint8_t>(code >> 8));
    }
    if (status != IoStatus::Ok) return status;
  }
  return IoStatus::Ok;
}

IoStatus Pci1720::checkPresence() noexcept {
  std::uint8_t id = 0;
  const IoStatus status = registers_.read8(pci1720::kBoardId, id);
  if (status != IoStatus::Ok) return status;
  if (id == kNobodyThere) return IoStatus::Disconnected;
  if ((id & kBoardIdMask) != board_id_) return IoStatus::DeviceError;
  // A card that was reset stands in 0..5 V: the code for 0 V would be 2.5 V there.
  std::uint8_t range = 0;
  const IoStatus answer = registers_.read8(pci1720::kRange, range);
  if (answer != IoStatus::Ok) return answer;
  return range == pci1720::kAllBipolar10V ? IoStatus::Ok : IoStatus::DeviceError;
}

IoStatus Pci1720::writeVolts(const std::array<double, kChannels>& volts,
                             std::array<double, kChannels>& written) noexcept {
  if (!ready_) return IoStatus::NotReady;
  std::array<std::uint16_t, kChannels> codes{};
  for (std::size_t channel = 0; channel < codes.size(); ++channel) {
    if (!std::isfinite(volts[channel])) return IoStatus::NotFinite;
    codes[channel] = codeFor(volts[channel]);
  }
  IoStatus status = stage(codes);
  if (status == IoStatus::Ok) status = checkPresence();
  if (status == IoStatus::Ok) status = registers_.write8(pci1720::kSynchronise, 0);
  if (status != IoStatus::Ok) return status;
  for (std::size_t channel = 0; channel < codes.size(); ++channel) {
    written[channel] = pci1720::toVolts(codes[channel], kBipolar10V);
  }
  return IoStatus::Ok;
}

}  // namespace knee_robot::hardware
