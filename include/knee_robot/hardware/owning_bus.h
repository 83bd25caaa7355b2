#pragma once

#include <array>
#include <utility>

#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/hardware/pci_axis_bus.h"
#include "knee_robot/hardware/pci_emergency_outputs.h"

namespace knee_robot::hardware {

/// A bus over two cards that it owns: `Cards` answers analog() and counter(), the registers of both. Forwards
/// everything.
template <typename Cards>
class OwningBus : public AxisBus {
 public:
  OwningBus(Cards cards, PciAxisBus::Options options)
      : cards_(std::move(cards)), bus_(cards_.analog(), cards_.counter(), options) {}
  SelfTest selfTest() override { return bus_.selfTest(); }
  IoStatus read(AxisFeedback& feedback) noexcept override { return bus_.read(feedback); }
  IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept override {
    return bus_.writeVolts(volts, written);
  }
  IoStatus writeOutputs(std::uint8_t bits) noexcept override { return bus_.writeOutputs(bits); }

 private:
  Cards cards_;
  PciAxisBus bus_;
};

/// A guardian's own handle to two cards that it owns.
template <typename Cards>
class OwningEmergencyOutputs : public EmergencyOutputs {
 public:
  explicit OwningEmergencyOutputs(Cards cards) : cards_(std::move(cards)) {}
  IoStatus down() noexcept override { return forceDown(cards_.analog(), cards_.counter()); }
  IoStatus carry(std::uint8_t bits, const std::array<double, kChannels>& volts) noexcept override {
    return forceCarry(cards_.analog(), cards_.counter(), bits, volts);
  }
  IoStatus readCounts(std::array<std::int32_t, kChannels>& counts) noexcept override {
    return latchedCounts(cards_.counter(), counts);
  }

 private:
  Cards cards_;
};

}  // namespace knee_robot::hardware
