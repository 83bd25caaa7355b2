#include "safety_inputs.h"

namespace knee_robot::control {

SafetyInputs::SafetyInputs(const HardwareFile& hardware)
    : emergency_stop_bit_(hardware.emergency_stop_clear_bit),
      hand_switch_bit_(hardware.hand_switch_clear_bit),
      enabling_switch_bit_(hardware.enabling_switch_bit),
      drives_ready_bit_(hardware.drives_ready_bit) {}

bool SafetyInputs::enablingSwitchHeld(const AxesMeasurement& measured) const noexcept {
  return enabling_switch_bit_ && measured.sequence != 0 && !isLow(enabling_switch_bit_, measured);
}

bool SafetyInputs::isLow(const std::optional<int>& bit, const AxesMeasurement& measured) noexcept {
  if (!bit || measured.sequence == 0) return false;
  return (measured.digital_inputs >> *bit & 1) == 0;
}

}  // namespace knee_robot::control
