#include "knee_robot/control/hardware_file.h"

#include <algorithm>
#include <set>

namespace knee_robot {
namespace {

HardwareFile::Axis readAxis(StrictMap& map, bool bench_without_patient) {
  HardwareFile::Axis axis;
  const std::string device = map.choice("hold_device", {"brake", "shorted_windings", "none"});
  if (device == "brake") axis.hold_device = HoldDevice::Brake;
  if (device == "shorted_windings") axis.hold_device = HoldDevice::ShortedWindings;
  if (device == "none" && !bench_without_patient) {
    map.refuse("hold_device",
               "none lets the platform fall when the drives are off; name a brake or shorted_windings, or set "
               "bench_without_patient: true for a bench that no patient is on");
  }
  axis.hold_delay_s = map.number("hold_delay_s", 0.0, 1.0);
  map.finish();
  return axis;
}

void readOutputs(HardwareFile& hardware, StrictMap map) {
  hardware.drive_enable_bit = map.integer("drive_enable", 0, 3);
  hardware.hold_release_bit = map.integer("hold_release", 0, 3);
  hardware.heartbeat_bit = map.integer("heartbeat", 0, 3);
  const std::set<int> bits = {hardware.drive_enable_bit, hardware.hold_release_bit, hardware.heartbeat_bit};
  if (bits.size() != 3) map.refuse("heartbeat", "drive_enable, hold_release and heartbeat need three different bits");
  map.finish();
}

}  // namespace

double HardwareFile::holdDelay() const {
  double delay = 0.0;
  for (const Axis& axis : axes)
    delay = std::max(delay, axis.hold_delay_s);
  return delay;
}

std::array<hardware::can::AxisUnits, hardware::kAxes> canUnits(const Robot& robot) {
  std::array<hardware::can::AxisUnits, hardware::kAxes> units{};
  for (std::size_t i = 0; i < units.size(); ++i) {
    const Actuator& actuator = robot.actuators.at(i);
    units[i].force_per_volt_N = actuator.force_per_volt_N;
    units[i].screw_lead_m = actuator.screw_lead_m;
    units[i].counts_per_revolution = actuator.counts_per_revolution;
  }
  return units;
}

HardwareFile loadHardwareFile(const std::string& path) {
  StrictMap file = StrictMap::load(path);
  HardwareFile hardware;
  hardware.path = path;
  hardware.backend = file.choice("backend", {"simulated", "pci", "can"});
  hardware.bench_without_patient = file.flagOr("bench_without_patient", false);
  readOutputs(hardware, file.map("digital_outputs"));
  if (auto inputs = file.mapIfAny("digital_inputs")) {
    hardware.emergency_stop_clear_bit = inputs->integer("emergency_stop_clear", 0, 3);
    inputs->finish();
  }
  hardware.drive_enable_delay_s = file.numberOr("drive_enable_delay_s", hardware.drive_enable_delay_s, 0.008, 1.0);
  std::vector<StrictMap> axes = file.maps("axes");
  if (axes.size() != 1 && axes.size() != hardware.axes.size()) {
    file.refuse("axes", "expected four axes, or one that stands for all, not " + std::to_string(axes.size()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i)
    hardware.axes[i] = readAxis(axes[i], hardware.bench_without_patient);
  if (axes.size() == 1) hardware.axes.fill(hardware.axes[0]);
  if (hardware.backend == "can") {
    hardware.can = hardware::can::readCanSettings(file.map("can"));
    hardware.can->drive_enable_bit = hardware.drive_enable_bit;
    hardware.can->enable_delay_s = hardware.drive_enable_delay_s;
  }
  file.finish();
  return hardware;
}

}  // namespace knee_robot
