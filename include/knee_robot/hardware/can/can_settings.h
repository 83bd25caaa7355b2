#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/can/units.h"

namespace knee_robot::hardware::can {

/// One drive as it must be found before it is enabled.
struct DriveSettings {
  int node = 0;
  std::optional<std::uint32_t> serial;  ///< 1018:4; none: any
  double rated_torque_Nm = 0.0;         ///< 6076
  double nominal_current_A = 0.0;       ///< 3001:1
  double current_limit_A = 0.0;         ///< 3001:2
};

/// Section `can` of a hardware file:
///
///     can:
///       interface: can0            # or the path of a simulated bus' socket
///       bit_rate: 1000000
///       period_s: 0.002            # of the deployment's servo activity; SYNC and all PDOs once a period
///       controller_node: 126       # ours, for the heartbeat
///       heartbeat_s: 0.02          # both ways; lost after 2.5 of them
///       missed_feedback: 3         # periods in a row without a drive's feedback, or with late ones
///       vendor: 251                # 1018:1 of all drives
///       product: 1                 # 1018:2
///       drives:                    # four, in the order of the axes
///         - {node: 1, rated_torque_Nm: 0.188, nominal_current_A: 3.12, current_limit_A: 4.68}     # optional: serial
struct CanSettings {
  std::string interface;
  double bit_rate = 1.0e6;
  double period_s = 0.002;
  int controller_node = 126;
  double heartbeat_s = 0.02;
  int missed_feedback = 3;
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::array<DriveSettings, kAxes> drives{};
  int drive_enable_bit = 0;     ///< of the digital outputs, from the hardware file
  double enable_delay_s = 0.1;  ///< until a drive that is enabled must be in Operation Enabled
};

/// Reads the section strictly; refuses traffic that does not fit on the bus. Throws InputError.
CanSettings readCanSettings(StrictMap map);

/// Throws InputError when the cyclic traffic of these settings does not fit; `where` begins the sentence.
void requireFits(const CanSettings& settings, const std::string& where);
/// Share of the bit rate at worst stuffing.
double busLoad(const CanSettings& settings);

/// Peak torque that the drive's current limit allows, per mille of the rated torque.
int torqueLimitPerMille(const DriveSettings& drive);

}  // namespace knee_robot::hardware::can
