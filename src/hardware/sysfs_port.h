#pragma once

#include <memory>
#include <optional>
#include <string>

#include "knee_robot/hardware/register_access.h"

namespace knee_robot::hardware {

/// Where a card is looked for.
struct CardQuery {
  std::uint16_t vendor = 0;
  std::uint16_t device = 0;
  std::uint32_t board_id_offset = 0;  ///< register whose bits 3..0 are the board id
  bool board_id_is_32_bits = false;   ///< width of that register
  std::optional<int> board_id;        ///< none: the only card of its kind
  std::string devices = "/sys/bus/pci/devices";
};

/// Registers of a real card through the kernel's sysfs: pread and pwrite of 1 or 4 bytes on BAR2's port I/O file, after
/// the device has been enabled. Some microseconds an access, no sleeping, no kernel driver of its own. Needs root (or
/// the right to these files) and a kernel that is not locked down; a kernel driver that claims the card must be
/// blacklisted. Source: the kernel's documentation of PCI resource files. Not yet run on a card by this project.
class SysfsPort : public RegisterAccess {
 public:
  /// Throws InputError that says which card is missing, claimed or closed to us, and how to mend it.
  static std::unique_ptr<SysfsPort> find(const CardQuery& query);
  /// Opens one device's folder, e.g. /sys/bus/pci/devices/0000:04:01.0. Throws InputError.
  explicit SysfsPort(const std::string& device_folder);
  ~SysfsPort() override;
  SysfsPort(const SysfsPort&) = delete;
  SysfsPort& operator=(const SysfsPort&) = delete;

  IoStatus read8(std::uint32_t offset, std::uint8_t& value) noexcept override;
  IoStatus read32(std::uint32_t offset, std::uint32_t& value) noexcept override;
  IoStatus write8(std::uint32_t offset, std::uint8_t value) noexcept override;
  IoStatus write32(std::uint32_t offset, std::uint32_t value) noexcept override;

  const std::string& folder() const noexcept { return folder_; }

 private:
  std::string folder_;
  int descriptor_ = -1;
};

}  // namespace knee_robot::hardware
