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
  switch (code) {
    case 0x8110:
      return "CAN overrun";
    case 0x8120:
      return "CAN error passive";
    case 0x8130:
      return "no heartbeat of the controller";
    case 0x8140:
      return "recovered from bus-off";
    case 0x8150:
      return "CAN identifier collision";
    case 0x8210:
      return "PDO length";
    case 0x8250:
      return "process data missing";
    default:
      break;
  }
  switch (code >> 8) {
    case 0x00:
      return "no error";
    case 0x10:
      return "generic error";
    case 0x20:
    case 0x21:
    case 0x22:
    case 0x23:
      return "over-current";
    case 0x30:
    case 0x31:
    case 0x32:
    case 0x33:
      return "supply voltage";
    case 0x40:
    case 0x41:
    case 0x42:
    case 0x43:
      return "over-temperature";
    case 0x50:
    case 0x51:
    case 0x52:
    case 0x53:
    case 0x54:
    case 0x55:
      return "device hardware";
    case 0x60:
    case 0x61:
    case 0x62:
    case 0x63:
      return "device software";
    case 0x70:
    case 0x71:
    case 0x72:
    case 0x73:
      return "additional module: encoder, brake or motor";
    case 0x80:
    case 0x81:
    case 0x82:
      return "communication";
    case 0x84:
      return "velocity controller";
    case 0x85:
    case 0x86:
      return "position controller";
    case 0x90:
      return "external error";
    case 0xF0:
      return "additional function";
    default:
      return code >= 0xFF00 ? "manufacturer specific" : "unknown class";
  }
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
