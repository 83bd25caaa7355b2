#pragma once

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// What the Supervisor has read in this cycle. All its parts look at the same view.
struct SupervisorView {
  AxesMeasurement measured;
  SetPoint set_point;
  std::array<AxisCommand, hardware::kAxes> commands{};  ///< of the Drivers
  AxesWritten written;                                  ///< of the last cycle
  MonitorVerdict verdict;
  Guidance guidance;
  int unreadable = 0;   ///< cycles in a row without readable encoders
  int unmonitored = 0;  ///< cycles in a row without a verdict of the Monitors
  int unguided = 0;     ///< cycles in a row without a word from HandGuide

  bool hasMeasured() const noexcept { return measured.sequence != 0; }
  bool drivesAreOff() const noexcept { return written.level == DriveLevel::Off; }
};

}  // namespace knee_robot::control
