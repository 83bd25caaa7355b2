#pragma once

#include <array>
#include <optional>
#include <string>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {

/// What holds a simulated axis while its hold output is 0.
enum class SimulatedHold {
  Brake,            ///< Coulomb friction of holding_force_N more
  ShortedWindings,  ///< viscous friction of shorted_viscous_N_s_per_m more
  None,
};

/// One simulated axis: what the machine has and the controller is not told.
struct AxisParameters {
  double viscous_N_s_per_m = 0.0;
  double coulomb_N = 0.0;
  double rotor_mass_kg = 5.6;  ///< motor and screw inertia reflected to the axis
  SimulatedHold hold_device = SimulatedHold::Brake;
  double holding_force_N = 1000.0;
  double hold_engage_delay_s = 0.03;
  double hold_release_delay_s = 0.03;
  double shorted_viscous_N_s_per_m = 1240.0;  ///< RE40 with a 10 mm screw (from its torque constant and resistance)
};

/// Mass fixed to the platform.
struct Payload {
  double mass_kg = 0.0;
  mechanism::Vector3 center_m = mechanism::Vector3::Zero();  ///< platform frame
  double radius_of_gyration_m = 0.0;                         ///< about any axis through its centre
};

/// Relay that is retriggered by every change of a digital output and takes the power from drives and holding brakes
/// otherwise.
struct HeartbeatRelay {
  int bit = 2;
  double hold_s = 0.02;
};

/// Content of a simulation file (YAML, SI, unknown keys are errors):
///
///     start_lengths_m: [0.6, 0.6, 0.6, 0.6]  # optional; default: the robot file's home lengths
///     axes:                                  # four, or one that stands for all
///       - {viscous_N_s_per_m: 150, coulomb_N: 15, rotor_mass_kg: 5.6, hold_device: brake, holding_force_N: 1000,
///          hold_engage_delay_s: 0.03, hold_release_delay_s: 0.03, shorted_viscous_N_s_per_m: 1240}
///     stop_margin_m: 0.005                   # optional; mechanical stops lie this far beyond the robot file's lengths
///     drive_delay_s: 0.008                   # optional; from the enable output's change until the drive follows
///     digital_outputs: {drive_enable: 0, hold_release: 1}   # optional; bits 0 to 3 of the counter card
///     digital_inputs: {emergency_stop_clear: 0, hand_switch_clear: 1, enabling_switch: 3, drives_ready: 2}  # optional
///     heartbeat_relay: {bit: 2, hold_s: 0.02}               # optional; no such relay without it
///     payload: {mass_kg: 15, center_m: [0, 0, 0.1], radius_of_gyration_m: 0.1}   # optional
///     substeps: 4                            # optional; integration steps per simulated period
///     effects:                               # optional; what else the machine has, see src/simulation/effects/
///       - {name: stribeck, actuators: [2], excess_N: 10, velocity_m_per_s: 0.005}
struct SimulationParameters {
  std::string path;
  std::optional<mechanism::Vector4> start_lengths_m;
  std::array<AxisParameters, mechanism::kLegs> axes{};
  double stop_margin_m = 0.005;
  double drive_delay_s = 0.008;
  int drive_enable_bit = 0;
  int hold_release_bit = 1;
  int emergency_stop_clear_bit = 0;
  std::optional<int> hand_switch_clear_bit;  ///< 1: not pressed and plugged in
  std::optional<int> enabling_switch_bit;    ///< 1: held
  std::optional<int> drives_ready_bit;       ///< 1: all drives are supplied
  std::optional<HeartbeatRelay> heartbeat_relay;
  std::optional<Payload> payload;
  int substeps = 4;
  EffectPrototypes effects;
};

/// Reads a simulation file strictly. InputError (file, line, limit).
SimulationParameters loadSimulationParameters(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
SimulationParameters parseSimulationParameters(const std::string& text, const std::string& name);

}  // namespace knee_robot::simulation
