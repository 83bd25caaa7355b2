#include "knee_robot/hardware/pci_cards.h"

#include <filesystem>

#include "knee_robot/hardware/owning_bus.h"
#include "knee_robot/hardware/pci1720_registers.h"
#include "knee_robot/hardware/pci1784_registers.h"
#include "sysfs_port.h"

namespace knee_robot::hardware {
namespace {

struct RealCards {
  std::unique_ptr<SysfsPort> analog_port;
  std::unique_ptr<SysfsPort> counter_port;
  RegisterAccess& analog() { return *analog_port; }
  RegisterAccess& counter() { return *counter_port; }
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

}  // namespace

std::unique_ptr<AxisBus> openPciCards(std::optional<int> analog_board_id, std::optional<int> counter_board_id) {
  PciAxisBus::Options options;
  options.analog_board_id = analog_board_id;
  options.counter.board_id = counter_board_id;
  return std::make_unique<OwningBus<RealCards>>(findRealCards(analog_board_id, counter_board_id), options);
}

std::string pciCardNames(std::optional<int> analog_board_id, std::optional<int> counter_board_id) {
  const RealCards cards = findRealCards(analog_board_id, counter_board_id);
  const auto name = [](const SysfsPort& port) {
    return std::filesystem::weakly_canonical(port.folder()).filename().string();
  };
  return name(*cards.analog_port) + " " + name(*cards.counter_port);
}

std::unique_ptr<EmergencyOutputs> openPciEmergencyOutputs(std::optional<int> analog_board_id,
                                                          std::optional<int> counter_board_id) {
  return std::make_unique<OwningEmergencyOutputs<RealCards>>(findRealCards(analog_board_id, counter_board_id));
}

}  // namespace knee_robot::hardware
