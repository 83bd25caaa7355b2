#pragma once

#include <memory>
#include <optional>
#include <string>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/hardware/shared_image.h"

namespace knee_robot::hardware {

/// The real cards, found by vendor, device and, when given, board id. Throws InputError when one is missing or not
/// accessible. The self test has not been run yet.
std::unique_ptr<AxisBus> openPciCards(std::optional<int> analog_board_id, std::optional<int> counter_board_id);

/// The cards of the simulated robot that runs under this shared memory name, through the same drivers. Throws
/// InputError.
std::unique_ptr<AxisBus> openSimulatedCards(const std::string& shared_memory_name);

/// The cards of a simulated robot in this process (stepped simulation). `image` must outlive the bus.
std::unique_ptr<AxisBus> openImageCards(RobotImage& image);

/// A guardian's own handles to the same cards. Opening them writes nothing to a card's registers. Throw InputError.
std::unique_ptr<EmergencyOutputs> openPciEmergencyOutputs(std::optional<int> analog_board_id,
                                                          std::optional<int> counter_board_id);
std::unique_ptr<EmergencyOutputs> openSimulatedEmergencyOutputs(const std::string& shared_memory_name);
std::unique_ptr<EmergencyOutputs> openImageEmergencyOutputs(RobotImage& image);

}  // namespace knee_robot::hardware
