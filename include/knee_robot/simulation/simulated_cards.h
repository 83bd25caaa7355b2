#pragma once

#include <memory>
#include <string>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/simulation/shared_image.h"

namespace knee_robot::simulation {

/// The cards of the simulated robot that runs under this shared memory name, through the same drivers as the real ones.
/// Throws InputError.
std::unique_ptr<hardware::AxisBus> openSimulatedCards(const std::string& shared_memory_name);

/// The cards of a simulated robot in this process (stepped simulation). `image` must outlive the bus.
std::unique_ptr<hardware::AxisBus> openImageCards(RobotImage& image);

/// A guardian's own handles to the same cards. Opening them writes nothing to a card's registers. Throw InputError.
std::unique_ptr<hardware::EmergencyOutputs> openSimulatedEmergencyOutputs(const std::string& shared_memory_name);
std::unique_ptr<hardware::EmergencyOutputs> openImageEmergencyOutputs(RobotImage& image);

}  // namespace knee_robot::simulation
