#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "knee_robot/control/machine_state.h"
#include "knee_robot/control/patient_memory.h"

namespace knee_robot::control {

/// The machine as the operator sees it.
struct ControlStatus {
  MachineState state = MachineState::Disabled;
  Fault fault = Fault::None;
  int fault_axis = 0;          ///< 1 to 4, 0: none in particular
  std::string fault_name;      ///< empty without fault
  std::string fault_sentence;  ///< cause, place and remedy; empty without fault
  std::string reference;       ///< name of the loaded reference, empty: none
  bool at_start = false;       ///< measured within Sync's start tolerance of the loaded reference's first point
  std::string playing;         ///< what is being played or paused (the reference or the approach to it), empty: nothing
  double path_time_s = 0.0;
  double path_duration_s = 0.0;
  double progress = 0.0;         ///< path_time / path_duration, 0 to 1; 0 before anything was played
  double time_scale = 0.0;       ///< speed of path time now, 0 to 1
  double speed_percent = 100.0;  ///< asked for by setSpeed()
  bool pause_asked = false;      ///< by pause(), since the last path began; it may have ended before it was at rest
  std::array<bool, hardware::kAxes> axis_homed{};
  bool homed = false;  ///< all axes: motion is possible
  bool bench_without_patient = false;
  std::array<double, hardware::kAxes> thermal{};  ///< I2t of each motor: 0 cold, 1 is the fault
  std::uint32_t safe_stops = 0;                   ///< completed since start()
  std::string recording;                          ///< path of the recording being written, empty: none
  std::uint64_t recorded_rows = 0;
  std::uint64_t dropped_rows = 0;            ///< measured but not in the file
  Occupancy occupancy = Occupancy::Unknown;  ///< nothing moves while it is Unknown
  std::string patient;                       ///< name in the loaded patient file, empty: none is loaded
  std::string black_box;                     ///< CSV of the newest fault, empty: none yet
  std::string black_box_error;               ///< the disk's refusal, faults that it was too slow for; empty: none
  std::uint64_t skipped_cycles = 0;          ///< left out by the machine: gaps of time_s
  std::string guiding;  ///< why the last guiding was refused, or ended by itself; empty: it did not
};

}  // namespace knee_robot::control
