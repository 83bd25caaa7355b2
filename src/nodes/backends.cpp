#include "backends.h"

#include <chrono>
#include <filesystem>
#include <thread>

#include "knee_robot/base/errors.h"
#include "knee_robot/hardware/can/can_axis_bus.h"
#include "knee_robot/hardware/guardian_link.h"
#include "knee_robot/hardware/pci_cards.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::nodes {
namespace {

using control::HardwareFile;
using mechanism::Robot;
using std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{10};

const Backend& backendOf(const HardwareFile& file) {
  for (const Backend& backend : backends()) {
    if (file.backend == backend.name) return backend;
  }
  throw InputError(file.path + ": nothing opens backend " + file.backend);
}

/// An interface by its name, a simulated bus by its path, however it is spelled.
std::string busName(const std::string& interface) {
  return interface.find('/') == std::string::npos ? interface : std::filesystem::weakly_canonical(interface).string();
}

template <typename Open>
auto waitFor(const Backend& backend, const Site& site, Open&& open) {
  const auto give_up = steady_clock::now() + kPatience;
  while (true) {
    try {
      return open();
    } catch (const InputError&) {
      if (!backend.starts_beside || site.stop_requested() || steady_clock::now() > give_up) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

const std::vector<Backend>& backends() {
  static const std::vector<Backend> all = {
      {"simulated", true,
       [](const HardwareFile&, const Robot&, const Site& site) {
         return simulation::openSimulatedCards(site.shared_memory);
       },
       [](const HardwareFile&, const Site& site) {
         return simulation::openSimulatedEmergencyOutputs(site.shared_memory);
       },
       [](const HardwareFile&, const Site& site) { return site.shared_memory; }},
      {"pci", false,
       [](const HardwareFile& file, const Robot&, const Site&) {
         return hardware::openPciCards(file.analog_board_id, file.counter_board_id);
       },
       [](const HardwareFile& file, const Site&) {
         return hardware::openPciEmergencyOutputs(file.analog_board_id, file.counter_board_id);
       },
       [](const HardwareFile& file, const Site&) {
         return hardware::pciCardNames(file.analog_board_id, file.counter_board_id);
       }},
      {"can", true,
       [](const HardwareFile& file, const Robot& robot, const Site&) {
         return hardware::can::openCanDrives(*file.can, control::canUnits(robot));
       },
       [](const HardwareFile& file, const Site&) { return hardware::can::openCanEmergencyOutputs(*file.can); },
       [](const HardwareFile& file, const Site&) { return busName(file.can->interface); }},
  };
  return all;
}

std::string machineName(const HardwareFile& file, const Site& site) {
  const Backend& backend = backendOf(file);
  return file.backend + " " + backend.identity(file, site);
}

std::uint64_t wiringMark(const HardwareFile& file) {
  std::string all;
  for (const int bit : {file.drive_enable_bit, file.hold_release_bit, file.heartbeat_bit})
    all += std::to_string(bit) + " ";
  return hardware::machineMark(all + std::to_string(file.holdDelay()) + (file.holdsByBrakes() ? " brakes" : ""));
}

std::string whyNotUnguarded(const HardwareFile& file, bool waits) {
  const std::string give = "give this controller the guardian's link (parameter ~guardian; controller.launch does)";
  if (waits) return "a guardian guards this machine, and this controller was not told of it: " + give + ", or end it";
  if (file.backend != "pci" || file.bench_without_patient) return "";
  return "no guardian: when this process dies, the cards keep what they were given last; start one and " + give +
         ", or set bench_without_patient: true in " + file.path + " for a bench that no patient is on";
}

std::unique_ptr<hardware::AxisBus> openBus(const HardwareFile& file, const Robot& robot, const Site& site) {
  const Backend& backend = backendOf(file);
  return waitFor(backend, site, [&] { return backend.bus(file, robot, site); });
}

std::unique_ptr<hardware::EmergencyOutputs> openOutputs(const HardwareFile& file, const Site& site) {
  const Backend& backend = backendOf(file);
  return waitFor(backend, site, [&] { return backend.outputs(file, site); });
}

}  // namespace knee_robot::nodes
