#pragma once

#include <mutex>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/control_status.h"
#include "machine_components.h"
#include "recording_drain.h"

namespace knee_robot::control {

/// Recordings on the operator's command, and what they need of the Drivers: test pulses are forces that no model
/// explains, and rows with them are left out of a fit. While a robot that is declared empty is recorded there are none
/// without a suspicion; with a patient they stay. Any thread.
class Recordings {
 public:
  /// `machine` must outlive this. `threaded`, `first_home_id`: see RecordingDrain.
  Recordings(const MachineComponents& machine, int axes, bool threaded, std::int64_t first_home_id)
      : machine_(machine), drain_(*machine.recorder, axes, threaded, first_home_id) {}

  /// Refused when the file exists.
  Answer start(const std::string& path);
  /// Not ok when rows were dropped or the disk refused, with the number, or when the file `only`, where one is given,
  /// is not being recorded any more.
  Answer stop(const std::string& only);
  /// Stepped execution: what was recorded goes to the file now.
  void drain() { drain_.drain(); }
  void setOccupancy(Occupancy occupancy);
  /// Fills in what is being recorded, and how many rows.
  void fill(ControlStatus& status) const;

 private:
  void chooseTestPulses();

  const MachineComponents& machine_;
  RecordingDrain drain_;
  std::mutex choosing_;  // what is seen last is what the Drivers hear last
  Occupancy occupancy_ = Occupancy::Unknown;
};

}  // namespace knee_robot::control
