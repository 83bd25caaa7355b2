#pragma once

#include <unistd.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/hardware/pci_axis_bus.h"
#include "knee_robot/simulation/shared_image.h"

namespace knee_robot::hardware {

/// Passes every access on and calls a hook after it: the moment at which a plant or an oscilloscope could look.
class SpyRegisters : public RegisterAccess {
 public:
  explicit SpyRegisters(RegisterAccess& target) : target_(target) {}
  std::function<void()> after_access;

  IoStatus read8(std::uint32_t offset, std::uint8_t& value) noexcept override {
    return done(target_.read8(offset, value));
  }
  IoStatus read32(std::uint32_t offset, std::uint32_t& value) noexcept override {
    return done(target_.read32(offset, value));
  }
  IoStatus write8(std::uint32_t offset, std::uint8_t value) noexcept override {
    return done(target_.write8(offset, value));
  }
  IoStatus write32(std::uint32_t offset, std::uint32_t value) noexcept override {
    return done(target_.write32(offset, value));
  }

 private:
  IoStatus done(IoStatus status) {
    if (after_access) after_access();
    return status;
  }
  RegisterAccess& target_;
};

inline std::string uniqueShmName(const std::string& purpose) {
  static int counter = 0;
  return "/knee_test_" + purpose + "_" + std::to_string(::getpid()) + "_" + std::to_string(counter++);
}

/// The two cards over an image, with what the conformance suite needs to see and to do at their far side.
class CardBench {
 public:
  explicit CardBench(simulation::RobotImage& image)
      : image_(image),
        analog_model_(image.analog),
        counter_model_(image.counter),
        analog_spy_(analog_model_),
        counter_spy_(counter_model_),
        bus_(analog_spy_, counter_spy_, PciAxisBus::Options{}) {
    analog_spy_.after_access = [this] { seen_outputs_.push_back(simulation::outputVolts(image_.analog)); };
    counter_spy_.after_access = [this] {
      if (moving_) move(1);
    };
  }

  AxisBus& bus() { return bus_; }
  static double lowestVolts() { return -10.0; }
  static double highestVolts() { return 10.0 - 20.0 / 4096.0; }
  static double voltStep() { return 20.0 / 4096.0; }

  std::array<double, kAxes> terminalVolts() const { return simulation::outputVolts(image_.analog); }
  std::uint8_t terminalOutputs() const { return image_.counter.outputs.load(); }
  void setInputs(std::uint8_t bits) { image_.counter.inputs.store(bits); }
  /// Turns all four encoders on by these counts.
  void move(std::uint32_t counts) {
    auto sums = simulation::publishedCounts(image_.counter);
    for (std::uint32_t& sum : sums)
      sum += counts;
    simulation::publishCounts(image_.counter, sums);
  }
  /// While set, all four encoders turn on by one count between any two accesses to the card.
  void keepMoving(bool on) { moving_ = on; }
  std::vector<std::array<double, kAxes>>& seenOutputs() { return seen_outputs_; }
  void disconnect() {
    image_.analog.disconnected.store(1);
    image_.counter.disconnected.store(1);
  }
  void reconnect() {
    image_.analog.disconnected.store(0);
    image_.counter.disconnected.store(0);
  }
  simulation::RobotImage& image() { return image_; }

 private:
  simulation::RobotImage& image_;
  simulation::Pci1720Model analog_model_;
  simulation::Pci1784Model counter_model_;
  SpyRegisters analog_spy_;
  SpyRegisters counter_spy_;
  PciAxisBus bus_;
  std::vector<std::array<double, kAxes>> seen_outputs_;
  bool moving_ = false;
};

/// Cards whose image lies on the heap (stepped simulation).
struct HeapCards {
  simulation::RobotImage image;
  CardBench bench{image};
};

/// Cards whose image lies in shared memory: the plant's handle and the controller's are two mappings.
struct SharedCards {
  simulation::SharedImage plant = simulation::SharedImage::create(uniqueShmName("bench"));
  simulation::SharedImage controller = simulation::SharedImage::attach(plant.name());
  CardBench bench{controller.image()};
};

}  // namespace knee_robot::hardware
