#include "knee_robot/simulation/simulation_parameters.h"

#include <set>
#include <vector>

#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::simulation {
namespace {

AxisParameters readAxis(StrictMap& axis) {
  AxisParameters result;
  result.viscous_N_s_per_m = axis.number("viscous_N_s_per_m", 0.0, 1e5);
  result.coulomb_N = axis.number("coulomb_N", 0.0, 1e4);
  result.rotor_mass_kg = axis.numberOr("rotor_mass_kg", result.rotor_mass_kg, 0.0, 1000.0);
  const std::string hold = axis.choiceOr("hold_device", "brake", {"brake", "shorted_windings", "none"});
  result.hold_device = hold == "brake"              ? SimulatedHold::Brake
                       : hold == "shorted_windings" ? SimulatedHold::ShortedWindings
                                                    : SimulatedHold::None;
  result.holding_force_N = axis.numberOr("holding_force_N", result.holding_force_N, 0.0, 1e5);
  result.hold_engage_delay_s = axis.numberOr("hold_engage_delay_s", result.hold_engage_delay_s, 0.0, 10.0);
  result.hold_release_delay_s = axis.numberOr("hold_release_delay_s", result.hold_release_delay_s, 0.0, 10.0);
  result.shorted_viscous_N_s_per_m =
      axis.numberOr("shorted_viscous_N_s_per_m", result.shorted_viscous_N_s_per_m, 0.0, 1e6);
  axis.finish();
  return result;
}

void readAxes(StrictMap& file, SimulationParameters& result) {
  std::vector<StrictMap> axes = file.maps("axes");
  if (axes.size() != 1 && axes.size() != result.axes.size()) {
    file.refuse("axes", "has " + std::to_string(axes.size()) + " entries; give four, or one that stands for all");
  }
  for (std::size_t i = 0; i < axes.size(); ++i)
    result.axes[i] = readAxis(axes[i]);
  if (axes.size() == 1) result.axes.fill(result.axes[0]);
}

void readLines(StrictMap& file, SimulationParameters& result) {
  if (auto outputs = file.mapIfAny("digital_outputs")) {
    result.drive_enable_bit = outputs->integer("drive_enable", 0, 3);
    result.hold_release_bit = outputs->integer("hold_release", 0, 3);
    if (result.drive_enable_bit == result.hold_release_bit) {
      outputs->refuse("hold_release", "is the same bit as drive_enable; each needs its own");
    }
    outputs->finish();
  }
  if (auto inputs = file.mapIfAny("digital_inputs")) {
    result.emergency_stop_clear_bit = inputs->integer("emergency_stop_clear", 0, 3);
    std::set<int> bits{result.emergency_stop_clear_bit};
    const auto bit = [&](const char* key, std::optional<int>& line) {
      if (!inputs->has(key)) return;
      line = inputs->integer(key, 0, 3);
      if (!bits.insert(*line).second) inputs->refuse(key, "is the bit of another input; each needs its own");
    };
    bit("hand_switch_clear", result.hand_switch_clear_bit);
    bit("enabling_switch", result.enabling_switch_bit);
    bit("drives_ready", result.drives_ready_bit);
    inputs->finish();
  }
}

void readRelay(StrictMap& file, SimulationParameters& result) {
  auto relay = file.mapIfAny("heartbeat_relay");
  if (!relay) return;
  HeartbeatRelay read;
  read.bit = relay->integer("bit", 0, 3);
  read.hold_s = relay->number("hold_s", 0.001, 10.0);
  relay->finish();
  result.heartbeat_relay = read;
}

void readPayload(StrictMap& file, SimulationParameters& result) {
  auto payload = file.mapIfAny("payload");
  if (!payload) return;
  Payload read;
  read.mass_kg = payload->number("mass_kg", 0.0, 500.0);
  const std::vector<double> center = payload->numbers("center_m", 3, -2.0, 2.0);
  read.center_m = {center[0], center[1], center[2]};
  read.radius_of_gyration_m = payload->numberOr("radius_of_gyration_m", 0.0, 0.0, 2.0);
  payload->finish();
  result.payload = read;
}

SimulationParameters read(StrictMap file, const std::string& path) {
  SimulationParameters result;
  result.path = path;
  if (file.has("start_lengths_m")) {
    const std::vector<double> lengths = file.numbers("start_lengths_m", mechanism::kLegs, 0.01, 10.0);
    result.start_lengths_m = mechanism::Vector4(lengths[0], lengths[1], lengths[2], lengths[3]);
  }
  readAxes(file, result);
  result.stop_margin_m = file.numberOr("stop_margin_m", result.stop_margin_m, 0.0, 1.0);
  result.drive_delay_s = file.numberOr("drive_delay_s", result.drive_delay_s, 0.0, 10.0);
  readLines(file, result);
  readRelay(file, result);
  readPayload(file, result);
  if (file.has("effects")) {
    for (StrictMap& entry : file.maps("effects"))
      result.effects.push_back(readEffect(entry));
  }
  result.substeps = file.integerOr("substeps", result.substeps, 1, 1000);
  file.finish();
  return result;
}

}  // namespace

SimulationParameters loadSimulationParameters(const std::string& path) {
  return read(StrictMap::load(path), path);
}

SimulationParameters parseSimulationParameters(const std::string& text, const std::string& name) {
  return read(StrictMap::parse(text, name), name);
}

}  // namespace knee_robot::simulation
