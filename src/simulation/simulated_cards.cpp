#include "knee_robot/simulation/simulated_cards.h"

#include "knee_robot/hardware/owning_bus.h"

namespace knee_robot::simulation {
namespace {

/// Models over an image; on the heap, so that the references held by the bus survive a move of this.
struct ModelCards {
  struct Pair {
    explicit Pair(RobotImage& image) : analog(image.analog), counter(image.counter) {}
    Pci1720Model analog;
    Pci1784Model counter;
  };
  std::unique_ptr<SharedImage> memory;  // empty: the image is somebody else's
  std::unique_ptr<Pair> models;
  hardware::RegisterAccess& analog() { return models->analog; }
  hardware::RegisterAccess& counter() { return models->counter; }
};

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

std::unique_ptr<hardware::AxisBus> openSimulatedCards(const std::string& shared_memory_name) {
  return std::make_unique<hardware::OwningBus<ModelCards>>(attachModelCards(shared_memory_name),
                                                           hardware::PciAxisBus::Options{});
}

std::unique_ptr<hardware::AxisBus> openImageCards(RobotImage& image) {
  return std::make_unique<hardware::OwningBus<ModelCards>>(modelCards(image), hardware::PciAxisBus::Options{});
}

std::unique_ptr<hardware::EmergencyOutputs> openSimulatedEmergencyOutputs(const std::string& shared_memory_name) {
  return std::make_unique<hardware::OwningEmergencyOutputs<ModelCards>>(attachModelCards(shared_memory_name));
}

std::unique_ptr<hardware::EmergencyOutputs> openImageEmergencyOutputs(RobotImage& image) {
  return std::make_unique<hardware::OwningEmergencyOutputs<ModelCards>>(modelCards(image));
}

}  // namespace knee_robot::simulation
