#include "knee_robot/hardware/can/can_settings.h"

#include <cmath>
#include <set>

#include "bus_load.h"
#include "knee_robot/hardware/can/canopen.h"

namespace knee_robot::hardware::can {
namespace {

constexpr double kLargestUnsigned = 4294967295.0;

std::uint32_t unsignedNumber(StrictMap& map, const std::string& key) {
  const double value = map.number(key, 0.0, kLargestUnsigned);
  if (value != std::floor(value)) map.refuse(key, "must be a whole number");
  return static_cast<std::uint32_t>(value);
}

DriveSettings readDrive(StrictMap& map) {
  DriveSettings drive;
  drive.node = map.integer("node", 1, kLargestNode);
  if (map.has("serial")) drive.serial = unsignedNumber(map, "serial");
  drive.rated_torque_Nm = map.number("rated_torque_Nm", 0.001, 1000.0);
  drive.nominal_current_A = map.number("nominal_current_A", 0.01, 1000.0);
  drive.current_limit_A = map.number("current_limit_A", 0.01, 1000.0);
  map.finish();
  return drive;
}

}  // namespace

double busLoad(const CanSettings& settings) {
  const double cycles = 1.0 / settings.period_s;
  const double beats = 1.0 / settings.heartbeat_s;
  return busLoad(
      {
          {0, cycles},          // SYNC
          {4, kAxes * cycles},  // command: control word, torque
          {4, kAxes * cycles},  // digital outputs, with the heartbeat for a relay in them
          {8, kAxes * cycles},  // feedback: status word, position, torque
          {4, cycles},          // digital inputs of the first drive
          {1, (kAxes + 1) * beats},
      },
      settings.bit_rate);
}

void requireFits(const CanSettings& settings, const std::string& where) {
  const double cycles = 1.0 / settings.period_s;
  requireFits({{0, busLoad(settings) * settings.bit_rate / longestFrameBits(0)}}, settings.bit_rate,
              where + std::to_string(static_cast<int>(std::lround(cycles))) + " cycles a second: ");
}

CanSettings readCanSettings(StrictMap map) {
  CanSettings settings;
  settings.interface = map.text("interface");
  settings.bit_rate = map.numberOr("bit_rate", settings.bit_rate, 10.0e3, 1.0e6);
  settings.period_s = map.numberOr("period_s", settings.period_s, 0.001, 0.02);
  settings.controller_node = map.integerOr("controller_node", settings.controller_node, 1, kLargestNode);
  settings.heartbeat_s = map.numberOr("heartbeat_s", settings.heartbeat_s, 0.005, 0.5);
  settings.missed_feedback = map.integerOr("missed_feedback", settings.missed_feedback, 1, 20);
  settings.vendor = unsignedNumber(map, "vendor");
  settings.product = unsignedNumber(map, "product");
  std::vector<StrictMap> drives = map.maps("drives");
  if (drives.size() != settings.drives.size()) {
    map.refuse("drives", "expected four drives, not " + std::to_string(drives.size()));
  }
  std::set<int> nodes = {settings.controller_node};
  for (std::size_t i = 0; i < drives.size(); ++i) {
    settings.drives[i] = readDrive(drives[i]);
    if (!nodes.insert(settings.drives[i].node).second) {
      map.refuse("drives", "node " + std::to_string(settings.drives[i].node) + " appears twice, or is controller_node");
    }
  }
  requireFits(settings, map.where("period_s"));
  map.finish();
  return settings;
}

int torqueLimitPerMille(const DriveSettings& drive) {
  return static_cast<int>(std::min(32767.0, 1000.0 * drive.current_limit_A / drive.nominal_current_A));
}

}  // namespace knee_robot::hardware::can
