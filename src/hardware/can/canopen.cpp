#include "knee_robot/hardware/can/canopen.h"

namespace knee_robot::hardware::can {
namespace {

bool isData(const Frame& frame) noexcept {
  return !frame.extended && !frame.remote && !frame.error;
}

/// Node of an identifier base + node; 0 when it is another one's.
int nodeIn(const Frame& frame, std::uint32_t base) noexcept {
  const bool inside = isData(frame) && frame.id > base && frame.id <= base + kLargestNode;
  return inside ? static_cast<int>(frame.id - base) : 0;
}

}  // namespace

Frame nmtFrame(NmtCommand command, int node) noexcept {
  Frame frame;
  frame.id = kNmtId;
  frame.length = 2;
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = static_cast<std::uint8_t>(node);
  return frame;
}

Frame syncFrame() noexcept {
  Frame frame;
  frame.id = kSyncId;
  return frame;
}

Frame heartbeatFrame(int node, NmtState state) noexcept {
  Frame frame;
  frame.id = kHeartbeatBase + static_cast<std::uint32_t>(node);
  frame.length = 1;
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

Frame emergencyFrame(const Emergency& emergency) noexcept {
  Frame frame;
  frame.id = kEmergencyBase + static_cast<std::uint32_t>(emergency.node);
  frame.length = 8;
  putUnsigned(frame, 0, 2, emergency.code);
  frame.data[2] = emergency.error_register;
  return frame;
}

bool isSync(const Frame& frame) noexcept {
  return isData(frame) && frame.id == kSyncId && frame.length <= 1;
}

std::optional<NmtOrder> parseNmt(const Frame& frame) noexcept {
  if (!isData(frame) || frame.id != kNmtId || frame.length != 2 || frame.data[1] > kLargestNode) return std::nullopt;
  switch (const auto command = static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::Start:
    case NmtCommand::Stop:
    case NmtCommand::EnterPreOperational:
    case NmtCommand::ResetNode:
    case NmtCommand::ResetCommunication:
      return NmtOrder{command, frame.data[1]};
  }
  return std::nullopt;
}

std::optional<Heartbeat> parseHeartbeat(const Frame& frame) noexcept {
  const int node = nodeIn(frame, kHeartbeatBase);
  if (node == 0 || frame.length != 1) return std::nullopt;
  switch (const auto state = static_cast<NmtState>(frame.data[0] & 0x7F)) {
    case NmtState::BootUp:
    case NmtState::Stopped:
    case NmtState::Operational:
    case NmtState::PreOperational:
      return Heartbeat{node, state};
  }
  return std::nullopt;
}

std::optional<Emergency> parseEmergency(const Frame& frame) noexcept {
  const int node = nodeIn(frame, kEmergencyBase);
  if (node == 0 || frame.length != 8) return std::nullopt;
  return Emergency{node, static_cast<std::uint16_t>(unsignedAt(frame, 0, 2)), frame.data[2]};
}

const char* emergencyText(std::uint16_t code) noexcept {
  struct Single {
    std::uint16_t code;
    const char* text;
  };
  struct Class {
    std::uint8_t first, last;  // of the code's upper byte
    const char* text;
  };
  static constexpr Single kSingles[] = {
      {0x8110, "CAN overrun"},
      {0x8120, "CAN error passive"},
      {0x8130, "no heartbeat of the controller"},
      {0x8140, "recovered from bus-off"},
      {0x8150, "CAN identifier collision"},
      {0x8210, "PDO length"},
      {0x8250, "process data missing"},
  };
  static constexpr Class kClasses[] = {
      {0x00, 0x00, "no error"},
      {0x10, 0x10, "generic error"},
      {0x20, 0x23, "over-current"},
      {0x30, 0x33, "supply voltage"},
      {0x40, 0x43, "over-temperature"},
      {0x50, 0x55, "device hardware"},
      {0x60, 0x63, "device software"},
      {0x70, 0x73, "additional module: encoder, brake or motor"},
      {0x80, 0x82, "communication"},
      {0x84, 0x84, "velocity controller"},
      {0x85, 0x86, "position controller"},
      {0x90, 0x90, "external error"},
      {0xF0, 0xF0, "additional function"},
      {0xFF, 0xFF, "manufacturer specific"},
  };
  for (const Single& single : kSingles)
    if (single.code == code) return single.text;
  const int upper = code >> 8;
  for (const Class& range : kClasses)
    if (range.first <= upper && upper <= range.last) return range.text;
  return "unknown class";
}

const char* toText(NmtState state) noexcept {
  switch (state) {
    case NmtState::BootUp:
      return "boot-up";
    case NmtState::Stopped:
      return "stopped";
    case NmtState::Operational:
      return "operational";
    case NmtState::PreOperational:
      return "pre-operational";
  }
  return "unknown";
}

}  // namespace knee_robot::hardware::can
