#include "knee_robot/hardware/open_bus.h"

#include <utility>

#include "knee_robot/hardware/pci1720_registers.h"
#include "knee_robot/hardware/pci1784_registers.h"
#include "knee_robot/hardware/pci_axis_bus.h"
#include "knee_robot/hardware/sysfs_port.h"

namespace knee_robot::hardware {
namespace {

/// A bus over two cards that it owns. Forwards everything.
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

struct RealCards {
  std::unique_ptr<SysfsPort> analog_port;
  std::unique_ptr<SysfsPort> counter_port;
  RegisterAccess& analog() { return *analog_port; }
  RegisterAccess& counter() { return *counter_port; }
};

/// Models over an image; on the heap, so that the references held by the bus survive a move of this.
struct ModelCards {
  struct Pair {
    explicit Pair(RobotImage& image) : analog(image.analog), counter(image.counter) {}
    Pci1720Model analog;
    Pci1784Model counter;
  };
  std::unique_ptr<SharedImage> memory;  // empty: the image is somebody else's
  std::unique_ptr<Pair> models;
  RegisterAccess& analog() { return models->analog; }
  RegisterAccess& counter() { return models->counter; }
};

template <typename Cards>
class OwningEmergencyOutputs : public EmergencyOutputs {
 public:
  explicit OwningEmergencyOutputs(Cards cards) : cards_(std::move(cards)) {}
  IoStatus down() noexcept override { return forceDown(cards_.analog(), cards_.counter()); }

 private:
  Cards cards_;
};

RealCards findRealCards(std::optional<int> analog_board_id, std::optional<int> counter_board_id) {
  CardQuery analog;
  analog.vendor = pci1720::kVendor;
  analog.device = pci1720::kDevice;
  analog.board_id_offset = pci1720::kBoardId;
  analog.board_id = analog_board_id;
  CardQuery counter;
  counter.vendor = pci1784::kVendor;
  counter.device = pci1784::kDevice;
  counter.board_id_offset = pci1784::kBoardId;
  counter.board_id_is_32_bits = true;
  counter.board_id = counter_board_id;
  return {SysfsPort::find(analog), SysfsPort::find(counter)};
}

ModelCards attachModelCards(const std::string& shared_memory_name) {
  ModelCards cards;
  cards.memory = std::make_unique<SharedImage>(SharedImage::attach(shared_memory_name));
  cards.models = std::make_unique<ModelCards::Pair>(cards.memory->image());
  return cards;
}

ModelCards modelCards(RobotImage& image) {
  ModelCards cards;
  cards.models = std::make_unique<ModelCards::Pair>(image);
  return cards;
}

}  // namespace

std::unique_ptr<AxisBus> openPciCards(std::optional<int> analog_board_id, std::optional<int> counter_board_id) {
  PciAxisBus::Options options;
  options.analog_board_id = analog_board_id;
  options.counter.board_id = counter_board_id;
  return std::make_unique<OwningBus<RealCards>>(findRealCards(analog_board_id, counter_board_id), options);
}

std::unique_ptr<AxisBus> openSimulatedCards(const std::string& shared_memory_name) {
  return std::make_unique<OwningBus<ModelCards>>(attachModelCards(shared_memory_name), PciAxisBus::Options{});
}

std::unique_ptr<AxisBus> openImageCards(RobotImage& image) {
  return std::make_unique<OwningBus<ModelCards>>(modelCards(image), PciAxisBus::Options{});
}

std::unique_ptr<EmergencyOutputs> openPciEmergencyOutputs(std::optional<int> analog_board_id,
                                                          std::optional<int> counter_board_id) {
  return std::make_unique<OwningEmergencyOutputs<RealCards>>(findRealCards(analog_board_id, counter_board_id));
}

std::unique_ptr<EmergencyOutputs> openSimulatedEmergencyOutputs(const std::string& shared_memory_name) {
  return std::make_unique<OwningEmergencyOutputs<ModelCards>>(attachModelCards(shared_memory_name));
}

std::unique_ptr<EmergencyOutputs> openImageEmergencyOutputs(RobotImage& image) {
  return std::make_unique<OwningEmergencyOutputs<ModelCards>>(modelCards(image));
}

}  // namespace knee_robot::hardware
