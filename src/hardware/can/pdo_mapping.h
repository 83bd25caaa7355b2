#pragma once

#include <vector>

#include "knee_robot/hardware/can/sdo.h"

namespace knee_robot::hardware::can {

/// One object in a PDO.
struct MappedObject {
  objects::Object object = 0;
  int bits = 0;
};

/// One process data object of a drive.
struct Pdo {
  bool transmit = false;  ///< from the drive
  int number = 0;         ///< 0 based: 0x1400 + number or 0x1800 + number
  std::uint32_t id = 0;   ///< identifier on the bus
  std::uint8_t type = 1;  ///< 1: at every SYNC; 255: at once (receive), on change (transmit)
  std::vector<MappedObject> objects;

  int bytes() const;
};

/// Not real-time. Writes it in the order that drives want (disable, count 0, entries, count, type, inhibit time 0,
/// enable) and reads everything back. Throws SdoError.
void configure(SdoClient& client, const Pdo& pdo);
/// Switches a PDO off that the drive may have by default.
void disable(SdoClient& client, bool transmit, int number, std::uint32_t id);

}  // namespace knee_robot::hardware::can
