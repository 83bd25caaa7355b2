#pragma once

#include <optional>

#include "knee_robot/control/hardware_file.h"

namespace knee_robot::control {

/// The digital inputs that somebody's hand is on, and the drives' own word. 1 is "all well" or "held", so that a broken
/// wire stops. What is not configured, or not measured yet, says nothing. Pure, real-time safe.
class SafetyInputs {
 public:
  explicit SafetyInputs(const HardwareFile& hardware);

  /// The emergency stop is pressed, or the drives' power is gone.
  bool emergencyStop(const AxesMeasurement& measured) const noexcept { return isLow(emergency_stop_bit_, measured); }
  /// The patient presses the hand switch.
  bool handSwitch(const AxesMeasurement& measured) const noexcept { return isLow(hand_switch_bit_, measured); }
  bool anyStop(const AxesMeasurement& measured) const noexcept {
    return emergencyStop(measured) || handSwitch(measured);
  }
  /// A drive has no supply or is in fault. Means something while the drives are on: some makers' outputs say ready only
  /// then.
  bool drivesNotReady(const AxesMeasurement& measured) const noexcept { return isLow(drives_ready_bit_, measured); }
  bool hasEnablingSwitch() const noexcept { return enabling_switch_bit_.has_value(); }
  bool enablingSwitchHeld(const AxesMeasurement& measured) const noexcept;
  bool enablingSwitchReleased(const AxesMeasurement& measured) const noexcept {
    return isLow(enabling_switch_bit_, measured);
  }

 private:
  static bool isLow(const std::optional<int>& bit, const AxesMeasurement& measured) noexcept;

  const std::optional<int> emergency_stop_bit_, hand_switch_bit_, enabling_switch_bit_, drives_ready_bit_;
};

}  // namespace knee_robot::control
