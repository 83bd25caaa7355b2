#pragma once

#include <string>
#include <vector>

#include "knee_robot/hardware/can/can_settings.h"
#include "knee_robot/hardware/can/frame_port.h"
#include "pdo_mapping.h"

namespace knee_robot::hardware::can {

/// The PDOs of every drive. Numbers 0 are cyclic with SYNC; receive PDO 1 (digital outputs) acts at once; transmit PDO
/// 1 (digital inputs) comes with SYNC from the first drive only.
Pdo commandPdo(int node);   ///< 6040, 6071
Pdo outputsPdo(int node);   ///< 60FE:1
Pdo feedbackPdo(int node);  ///< 6041, 6064, 6077
Pdo inputsPdo(int node);    ///< 60FD

/// Not real-time. Brings one drive down (quick stop when it is enabled, torque 0, digital outputs 0), resets its
/// communication, verifies identity and limits, configures mode, stop options, heartbeats and PDOs with read-back,
/// resets a fault, and starts its node. Appends a sentence to `findings`; false when the drive is absent, another one,
/// or refuses something.
bool setUpDrive(FramePort& service, const CanSettings& settings, std::size_t axis, std::vector<std::string>& findings);

}  // namespace knee_robot::hardware::can
