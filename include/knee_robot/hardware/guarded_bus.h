#pragma once

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/guardian_link.h"

namespace knee_robot::hardware {

/// The controller's bus while a guardian watches: passes everything on, tells the guardian that the controller lives and whether
/// drives are on, and refuses every write (FencedOut) from the moment at which the guardian has acted until reclaim().
///
/// A controller that was stopped between the look at the fence and the write behind it, and comes back, still gets that one
/// write through: the guardian's next cycle takes it back.
class GuardedBus : public AxisBus {
 public:
  /// Both must outlive this. `power_bits`: digital outputs that enable drives or release hold devices.
  GuardedBus(AxisBus& bus, GuardianLink& link, std::uint8_t power_bits);

  /// Fails when another controller lives, or no guardian answers. Takes a guardian's latch back: the drives are off.
  SelfTest selfTest() override;
  IoStatus read(AxisFeedback& feedback) noexcept override { return bus_.read(feedback); }
  IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept override;
  IoStatus writeOutputs(std::uint8_t bits) noexcept override;
  bool isFencedOut() const noexcept override;
  /// Waits up to 0.3 s for the guardian.
  IoStatus reclaim() override;
  BusFailure failure() const noexcept override { return bus_.failure(); }
  void acknowledgeFaults() noexcept override { bus_.acknowledgeFaults(); }

 private:
  AxisBus& bus_;
  GuardianLink& link_;
  const std::uint8_t power_bits_;
};

}  // namespace knee_robot::hardware
