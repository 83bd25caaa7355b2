#pragma once

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/pci1720.h"
#include "knee_robot/hardware/pci1784.h"

namespace knee_robot::hardware {

/// The robot's two cards as one bus: set values through a PCI-1720, encoders and digital lines through a PCI-1784.
class PciAxisBus : public AxisBus {
 public:
  /// Which of several cards.
  struct Options {
    std::optional<int> analog_board_id;
    Pci1784::Options counter;
  };

  /// Both must outlive the bus.
  PciAxisBus(RegisterAccess& analog, RegisterAccess& counter, Options options);

  /// Digital outputs off first, so that the drives are disabled when the analog outputs are brought to 0 V.
  SelfTest selfTest() override;
  IoStatus read(AxisFeedback& feedback) noexcept override;
  IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept override;
  IoStatus writeOutputs(std::uint8_t bits) noexcept override;

 private:
  Pci1720 analog_;
  Pci1784 counter_;
  bool ready_ = false;
};

}  // namespace knee_robot::hardware
