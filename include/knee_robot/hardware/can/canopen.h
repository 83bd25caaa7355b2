#pragma once

#include <cstdint>
#include <optional>

#include "knee_robot/hardware/can/frame.h"

/// CANopen (CiA 301) frames with the identifiers of the predefined connection set. Parsers take any frame and answer
/// nothing for one that is not theirs. Real-time safe.
namespace knee_robot::hardware::can {

inline constexpr std::uint32_t kNmtId = 0x000;
inline constexpr std::uint32_t kSyncId = 0x080;
inline constexpr std::uint32_t kEmergencyBase = 0x080;
inline constexpr std::uint32_t kTransmitPdoBase = 0x180;  ///< + 0x100 n + node
inline constexpr std::uint32_t kReceivePdoBase = 0x200;   ///< + 0x100 n + node
inline constexpr std::uint32_t kSdoAnswerBase = 0x580;
inline constexpr std::uint32_t kSdoRequestBase = 0x600;
inline constexpr std::uint32_t kHeartbeatBase = 0x700;
inline constexpr int kLargestNode = 127;

enum class NmtCommand : std::uint8_t {
  Start = 1,
  Stop = 2,
  EnterPreOperational = 128,
  ResetNode = 129,
  ResetCommunication = 130,
};

enum class NmtState : std::uint8_t { BootUp = 0, Stopped = 4, Operational = 5, PreOperational = 127 };

/// To one node, or to all with node 0.
Frame nmtFrame(NmtCommand command, int node) noexcept;
Frame syncFrame() noexcept;
Frame heartbeatFrame(int node, NmtState state) noexcept;

/// What the network master orders a node (0: all nodes) to do (CiA 301).
struct NmtOrder {
  NmtCommand command = NmtCommand::Start;
  int node = 0;
};
/// A node lives, and in which state (CiA 301).
struct Heartbeat {
  int node = 0;
  NmtState state = NmtState::BootUp;
};
/// Emergency: 0 is "error reset or no error".
struct Emergency {
  int node = 0;
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;
};

std::optional<NmtOrder> parseNmt(const Frame& frame) noexcept;
std::optional<Heartbeat> parseHeartbeat(const Frame& frame) noexcept;
std::optional<Emergency> parseEmergency(const Frame& frame) noexcept;
bool isSync(const Frame& frame) noexcept;

Frame emergencyFrame(const Emergency& emergency) noexcept;

/// Kind of an emergency or error code (603F), by its class as CiA 301 and CiA 402 list them: "over-current".
const char* emergencyText(std::uint16_t code) noexcept;
/// "pre-operational"
const char* toText(NmtState state) noexcept;

}  // namespace knee_robot::hardware::can
