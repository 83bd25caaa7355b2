#pragma once

#include <cstdint>

#include "knee_robot/hardware/io_status.h"

namespace knee_robot::hardware {

/// Registers of one card: accesses of a stated width at an offset into its base address region 2 (BAR2). Behind it is
/// the real card (SysfsPort) or a register-level model of it; the card drivers cannot tell which. Little endian.
/// Real-time safe.
class RegisterAccess {
 public:
  virtual ~RegisterAccess() = default;
  /// `value` is untouched unless Ok.
  virtual IoStatus read8(std::uint32_t offset, std::uint8_t& value) noexcept = 0;
  virtual IoStatus read32(std::uint32_t offset, std::uint32_t& value) noexcept = 0;
  virtual IoStatus write8(std::uint32_t offset, std::uint8_t value) noexcept = 0;
  virtual IoStatus write32(std::uint32_t offset, std::uint32_t value) noexcept = 0;
};

}  // namespace knee_robot::hardware
