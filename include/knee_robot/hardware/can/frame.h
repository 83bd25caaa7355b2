#pragma once

#include <array>
#include <cstdint>

namespace knee_robot::hardware::can {

/// A classic CAN frame. CANopen as used here has 11-bit identifiers and no remote frames.
struct Frame {
  std::uint32_t id = 0;                ///< 11 bits (29 with `extended`); of an error frame: the kernel's error classes
  std::uint8_t length = 0;             ///< 0 to 8
  std::array<std::uint8_t, 8> data{};  ///< bytes from `length` on are 0
  bool extended = false;
  bool remote = false;
  bool error = false;            ///< not from the bus: the controller's driver tells about an error
  std::int64_t received_ns = 0;  ///< when it was received, by FramePort::now()'s clock
};

/// Little endian, as CANopen has it. `count` 1 to 4 bytes from `offset`; bytes beyond the frame's 8 are not read.
constexpr std::uint32_t unsignedAt(const Frame& frame, std::size_t offset, std::size_t count) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count && offset + i < frame.data.size(); ++i)
    value |= static_cast<std::uint32_t>(frame.data[offset + i]) << (8 * i);
  return value;
}

constexpr void putUnsigned(Frame& frame, std::size_t offset, std::size_t count, std::uint32_t value) noexcept {
  for (std::size_t i = 0; i < count && offset + i < frame.data.size(); ++i)
    frame.data[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace knee_robot::hardware::can
