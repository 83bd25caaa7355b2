#include "knee_robot/hardware/pci_axis_bus.h"

namespace knee_robot::hardware {

PciAxisBus::PciAxisBus(RegisterAccess& analog, RegisterAccess& counter, Options options)
    : analog_(analog, options.analog_board_id), counter_(counter, options.counter) {}

SelfTest PciAxisBus::selfTest() {
  SelfTest result;
  ready_ = false;
  result.passed = counter_.disableOutputs(result.findings) && analog_.initialise(result.findings) &&
                  counter_.initialiseCounters(result.findings);
  ready_ = result.passed;
  return result;
}

IoStatus PciAxisBus::read(AxisFeedback& feedback) noexcept {
  AxisFeedback fresh;
  IoStatus status = counter_.readCounts(fresh.counts);
  if (status == IoStatus::Ok) status = counter_.readInputs(fresh.digital_inputs);
  if (status == IoStatus::Ok) feedback = fresh;
  return status;
}

IoStatus PciAxisBus::writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept {
  return ready_ ? analog_.writeVolts(volts, written) : IoStatus::NotReady;
}

IoStatus PciAxisBus::writeOutputs(std::uint8_t bits) noexcept {
  return ready_ ? counter_.writeOutputs(bits) : IoStatus::NotReady;
}

}  // namespace knee_robot::hardware
