#pragma once

#include <memory>
#include <optional>
#include <string>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/emergency_outputs.h"

namespace knee_robot::hardware {

/// The real cards, found by vendor, device and, when given, board id. Throws InputError when one is missing or not
/// accessible. The self test has not been run yet.
std::unique_ptr<AxisBus> openPciCards(std::optional<int> analog_board_id, std::optional<int> counter_board_id);

/// Where the kernel has these two cards (folders' names in sysfs), however they were asked for. Throws InputError as
/// openPciCards().
std::string pciCardNames(std::optional<int> analog_board_id, std::optional<int> counter_board_id);

/// A guardian's own handle to the same cards. Opening it writes nothing to a card's registers. Throws InputError.
std::unique_ptr<EmergencyOutputs> openPciEmergencyOutputs(std::optional<int> analog_board_id,
                                                          std::optional<int> counter_board_id);

}  // namespace knee_robot::hardware
