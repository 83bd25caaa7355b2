#pragma once

#include <cstdint>

namespace knee_robot::hardware::can {

/// States of a CiA 402 drive, as its status word tells them (masks 0x4F and 0x6F).
enum class DriveState : std::uint8_t {
  NotReady,
  SwitchOnDisabled,
  ReadyToSwitchOn,
  SwitchedOn,
  OperationEnabled,
  QuickStopActive,
  FaultReaction,
  Fault,
  Unknown,  ///< bits that mean nothing
};

/// What is wanted of a drive.
enum class DriveGoal : std::uint8_t {
  Off,        ///< no torque, power stage off
  Enabled,    ///< Operation Enabled
  QuickStop,  ///< stop as object 605A says, then off
};

inline constexpr std::uint16_t kShutdown = 0x06;
inline constexpr std::uint16_t kSwitchOn = 0x07;
inline constexpr std::uint16_t kEnableOperation = 0x0F;
inline constexpr std::uint16_t kDisableVoltage = 0x00;
inline constexpr std::uint16_t kQuickStop = 0x02;
inline constexpr std::uint16_t kFaultReset = 0x80;  ///< acts on its rising edge

DriveState stateOf(std::uint16_t status_word) noexcept;

/// Control word that brings a drive in this state one step nearer to the goal; where it holds it, when it is there. A
/// drive in Fault gets kDisableVoltage: a fault is reset on request only (FaultReset).
std::uint16_t controlWord(DriveState state, DriveGoal goal) noexcept;

/// Rising edges of the fault reset bit: once low, once high, until the fault is gone or the patience is over.
class FaultReset {
 public:
  void request() noexcept { cycles_ = kPatience; }
  bool pending() const noexcept { return cycles_ > 0; }
  /// Every cycle: what is sent instead of `usual`.
  std::uint16_t controlWord(DriveState state, std::uint16_t usual) noexcept;

 private:
  static constexpr int kPatience = 100;  // cycles
  int cycles_ = 0;
};

/// "operation enabled"
const char* toText(DriveState state) noexcept;

}  // namespace knee_robot::hardware::can
