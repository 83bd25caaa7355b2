#pragma once

#include <array>
#include <optional>
#include <string>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/control/homing_move.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/can/can_settings.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// Values of `backend:`: how the axes are reached (src/nodes/backends.cpp opens them).
inline constexpr std::array<const char*, 3> kBackends = {"simulated", "pci", "can"};

/// What holds an axis when its drive is disabled.
enum class HoldDevice {
  Brake,            ///< engaged by spring, released by a digital output
  ShortedWindings,  ///< a relay shorts the motor: it does not hold, but lets the platform sink slowly
  None,             ///< the axis falls freely: no patient
};

/// How the axes learn where they are: incremental encoders know nothing when they are switched on.
enum class HomingMethod {
  Assumed,  ///< the robot stands at home (or where the program says) when the controller starts: simulation and benches
  HandPlaced,  ///< somebody puts it there with the drives off, and confirms
  Switch,      ///< each axis runs slowly against a switch
  HardStop,    ///< each axis runs slowly and with low force against the end of its stroke
};

/// Content of a hardware file:
///
///     backend: simulated              # or pci (the cards), can (drives on a CAN bus); read by nodes/backends
///     can: {...}                      # backend can only: see hardware/can/can_settings.h
///     bench_without_patient: false    # optional; hold_device none needs true
///     digital_outputs: {drive_enable: 0, hold_release: 1, heartbeat: 2}   # bits 0 to 3; 1: enabled, released
///     digital_inputs:                 # optional, bits 0 to 3, different; 1: all well, so that a broken wire stops
///       {emergency_stop_clear: 0,     # not pressed, drive power present
///        hand_switch_clear: 1,        # the patient's hand switch is not pressed
///        drives_ready: 2,             # the ready outputs of all drives in series: supplied and not in fault
///        enabling_switch: 3,          # 1 = held; for hand guiding, a switch that opens when it is let go of
///        home_switch: 2}              # 1: closed; for homing against a switch (one line for all axes)
///     cards: {analog_board_id: 0, counter_board_id: 1}   # optional, backend pci: the switches on the cards
///     drive_enable_delay_s: 0.02      # optional; until an enabled drive follows, and a disabled one is off
///     starts_faulted: true            # optional; after every start the operator has to reset first (not_reset)
///     homing: {method: hand_placed}   # default; or assumed (simulated or bench_without_patient only); or
///       # {method: switch, order: [4, 1, 2, 3], axes: [{length_m: 0.6, direction: shorten, speed_m_per_s: 0.003,
///       #  force_N: 60, back_off_m: 0.01, travel_m: 0.35}]}    # or method hard_stop; four axes or one for all
///     axes:                           # four, or one that stands for all
///       - {hold_device: brake, hold_delay_s: 0.03}   # from the output's change until it holds (or lets go)
struct HardwareFile {
  /// What holds one axis without its drive.
  struct Axis {
    HoldDevice hold_device = HoldDevice::None;
    double hold_delay_s = 0.0;
  };

  /// How the axes find home.
  struct Homing {
    HomingMethod method = HomingMethod::Assumed;
    std::array<HomingAxis, hardware::kAxes> axes{};      ///< of the methods that move
    std::array<int, hardware::kAxes> order{1, 2, 3, 4};  ///< one axis after the other
    std::optional<int> switch_bit;                       ///< digital input, 1 = closed

    bool moves() const { return method == HomingMethod::Switch || method == HomingMethod::HardStop; }
  };

  std::string path;
  std::string backend;                            ///< one of kBackends
  std::optional<hardware::can::CanSettings> can;  ///< engaged for backend can
  bool bench_without_patient = false;
  int drive_enable_bit = 0;
  int hold_release_bit = 1;
  int heartbeat_bit = 2;
  std::optional<int> emergency_stop_clear_bit;
  std::optional<int> hand_switch_clear_bit;
  std::optional<int> enabling_switch_bit;
  std::optional<int> drives_ready_bit;
  Homing homing;
  bool starts_faulted = false;
  std::optional<int> analog_board_id;  ///< backend pci: which card, when there are several
  std::optional<int> counter_board_id;
  double drive_enable_delay_s = 0.02;
  std::array<Axis, hardware::kAxes> axes{};

  /// The slowest holding brake.
  double holdDelay() const;
  /// Each axis has a brake: none moves when they have engaged. Shorted windings let the platform sink.
  bool holdsByBrakes() const;
};

/// Reads a hardware file strictly. InputError (file, line, limit) for anything unknown or senseless, and for
/// hold_device none without bench_without_patient.
HardwareFile loadHardwareFile(const std::string& path);

/// What turns the robot's set values into drive torques; rated torques come from the `can` section.
std::array<hardware::can::AxisUnits, hardware::kAxes> canUnits(const mechanism::Robot& robot);

}  // namespace knee_robot::control
