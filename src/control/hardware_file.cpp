#include "knee_robot/control/hardware_file.h"

#include <algorithm>
#include <set>

namespace knee_robot::control {
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

void readInputs(HardwareFile& hardware, StrictMap map) {
  std::set<int> bits;
  const auto bit = [&](const char* key, std::optional<int>& line) {
    if (!map.has(key)) return;
    line = map.integer(key, 0, 3);
    if (!bits.insert(*line).second) map.refuse(key, "another input has this bit already; every input needs its own");
  };
  bit("emergency_stop_clear", hardware.emergency_stop_clear_bit);
  bit("hand_switch_clear", hardware.hand_switch_clear_bit);
  bit("enabling_switch", hardware.enabling_switch_bit);
  bit("drives_ready", hardware.drives_ready_bit);
  bit("home_switch", hardware.homing.switch_bit);
  map.finish();
}

void readCards(HardwareFile& hardware, StrictMap map) {
  if (hardware.backend != "pci") map.refuse("analog_board_id", "only backend pci has cards to choose from");
  if (map.has("analog_board_id")) hardware.analog_board_id = map.integer("analog_board_id", 0, 15);
  if (map.has("counter_board_id")) hardware.counter_board_id = map.integer("counter_board_id", 0, 15);
  map.finish();
}

HomingAxis readHomingAxis(StrictMap& map) {
  HomingAxis axis;
  axis.length_m = map.number("length_m", -2.0, 2.0);
  axis.direction = map.choice("direction", {"shorten", "lengthen"}) == "lengthen" ? 1 : -1;
  axis.speed_m_per_s = map.numberOr("speed_m_per_s", axis.speed_m_per_s, 1e-4, 0.02);
  axis.force_N = map.numberOr("force_N", axis.force_N, 1.0, 200.0);
  // Only the way back tells that the axis moves, that its encoder counts, and that a switch opens again.
  axis.back_off_m = map.numberOr("back_off_m", axis.back_off_m, HomingMove::kLeastBackOff_m, 0.1);
  axis.travel_m = map.numberOr("travel_m", axis.travel_m, 0.001, 2.0);
  map.finish();
  return axis;
}

void readHomingOrder(HardwareFile& hardware, StrictMap& map) {
  if (!map.has("order")) return;
  const std::vector<double> order = map.numbers("order", hardware.axes.size(), 1.0, 4.0);
  std::set<int> seen;
  for (std::size_t i = 0; i < order.size(); ++i) {
    hardware.homing.order[i] = static_cast<int>(order[i]);
    if (hardware.homing.order[i] != order[i] || !seen.insert(hardware.homing.order[i]).second)
      map.refuse("order", "expected each of the axes 1 to 4 once");
  }
}

void readHoming(HardwareFile& hardware, StrictMap map) {
  const std::string method = map.choice("method", {"assumed", "hand_placed", "switch", "hard_stop"});
  if (method == "assumed" && hardware.backend != "simulated" && !hardware.bench_without_patient) {
    map.refuse(
        "method",
        "assumed takes for granted that the robot stands at home, which no encoder confirms; use hand_placed, switch "
        "or hard_stop, or set bench_without_patient: true");
  }
  hardware.homing.method = method == "assumed"     ? HomingMethod::Assumed
                           : method == "switch"    ? HomingMethod::Switch
                           : method == "hard_stop" ? HomingMethod::HardStop
                                                   : HomingMethod::HandPlaced;
  if (hardware.homing.moves()) {
    if (method == "switch" && !hardware.homing.switch_bit) {
      map.refuse("method", "switch needs the bit of the switches: digital_inputs: {home_switch: ...}");
    }
    std::vector<StrictMap> axes = map.maps("axes");
    if (axes.size() != 1 && axes.size() != hardware.axes.size()) {
      map.refuse("axes", "expected four axes, or one that stands for all, not " + std::to_string(axes.size()));
    }
    for (std::size_t i = 0; i < axes.size(); ++i)
      hardware.homing.axes[i] = readHomingAxis(axes[i]);
    if (axes.size() == 1) hardware.homing.axes.fill(hardware.homing.axes[0]);
    readHomingOrder(hardware, map);
  }
  map.finish();
}

}  // namespace

double HardwareFile::holdDelay() const {
  double delay = 0.0;
  for (const Axis& axis : axes)
    delay = std::max(delay, axis.hold_delay_s);
  return delay;
}

bool HardwareFile::holdsByBrakes() const {
  return std::all_of(axes.begin(), axes.end(), [](const Axis& axis) { return axis.hold_device == HoldDevice::Brake; });
}

std::array<hardware::can::AxisUnits, hardware::kAxes> canUnits(const mechanism::Robot& robot) {
  std::array<hardware::can::AxisUnits, hardware::kAxes> units{};
  for (std::size_t i = 0; i < units.size(); ++i) {
    const mechanism::Actuator& actuator = robot.actuators.at(i);
    units[i].force_per_volt_N = actuator.force_per_volt_N;
    units[i].screw_lead_m = actuator.screw_lead_m;
  }
  return units;
}

HardwareFile loadHardwareFile(const std::string& path) {
  StrictMap file = StrictMap::load(path);
  HardwareFile hardware;
  hardware.path = path;
  hardware.backend = file.choice("backend", {kBackends.begin(), kBackends.end()});
  hardware.bench_without_patient = file.flagOr("bench_without_patient", false);
  readOutputs(hardware, file.map("digital_outputs"));
  if (auto inputs = file.mapIfAny("digital_inputs")) readInputs(hardware, *inputs);
  if (auto cards = file.mapIfAny("cards")) readCards(hardware, *cards);
  hardware.starts_faulted = file.flagOr("starts_faulted", true);
  hardware.homing.method = HomingMethod::HandPlaced;
  if (auto homing = file.mapIfAny("homing")) readHoming(hardware, *homing);
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

}  // namespace knee_robot::control
