#pragma once

#include <cstdint>

namespace knee_robot::hardware {

/// What a bus of intelligent drives may tell beyond IoStatus: why the machine has to stop, and which axis it is about.
enum class BusFault : std::uint8_t {
  None,
  InterfaceDown,            ///< the CAN interface is down or gone
  BusOff,                   ///< the CAN controller has left the bus
  Flooded,                  ///< more frames than can be worth reading, or no room to send
  DriveLost,                ///< a drive's feedback stays away, or it has left the operational state
  FeedbackLate,             ///< feedback comes late, twice, out of order or too seldom
  DriveHeartbeatLost,       ///< no heartbeat of the drive
  ControllerHeartbeatLost,  ///< the drive says that it missed ours, and has stopped
  DriveEmergency,           ///< the drive has sent an emergency; `code` is its error code
  DriveFault,               ///< the drive is in Fault
  DriveNotEnabled,          ///< the drive left Operation Enabled or did not reach it
  InputsStale,              ///< the drive that reads the safety inputs does not report them any more
  TorqueDeviates,           ///< the drive gives another torque than it was told
  DriveStaysOn,             ///< the drive reports Operation Enabled although it was told to switch off
  GuardianSilent,           ///< nobody would bring the outputs down if the controller died
};

/// Whether it leaves an axis without loop: no drive that obeys, or no feedback. Such a failure comes before all others,
/// because nothing can slow down along its path any more.
constexpr bool breaksTheLoop(BusFault fault) noexcept {
  switch (fault) {
    case BusFault::InterfaceDown:
    case BusFault::BusOff:
    case BusFault::DriveLost:
    case BusFault::ControllerHeartbeatLost:
    case BusFault::DriveFault:
    case BusFault::DriveNotEnabled:
    case BusFault::TorqueDeviates:
    case BusFault::DriveStaysOn:
      return true;
    case BusFault::None:
    case BusFault::Flooded:
    case BusFault::FeedbackLate:
    case BusFault::DriveHeartbeatLost:
    case BusFault::DriveEmergency:
    case BusFault::InputsStale:
    case BusFault::GuardianSilent:
      return false;
  }
  return true;
}

/// What a bus of drives says of itself beyond "lost".
struct BusFailure {
  BusFault fault = BusFault::None;
  std::uint8_t axis = 0;    ///< 1 to 4; 0: all
  std::uint16_t code = 0;   ///< the drive's emergency code, 0: none
  std::uint8_t silent = 0;  ///< bit i: no feedback of axis i + 1 in the last two periods or more; its counts are old
};

}  // namespace knee_robot::hardware
