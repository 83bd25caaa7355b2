#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <array>
#include <atomic>
#include <vector>

#include "controller_machine.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/rt/statistics.h"

namespace knee_robot::nodes {

/// From where on a figure is a warning or an error; private parameters `~diagnostics/NAME`.
struct DiagnosticThresholds {
  double tracking_warn_m = 0.002, tracking_error_m = 0.005;   ///< largest |reference - position| of the last second
  double lateness_warn_s = 0.0005, lateness_error_s = 0.005;  ///< 99 % of the last second's servo cycles
  double execution_warn = 0.5, execution_error = 0.9;         ///< share of the period, 99 %
  double limit_warn = 0.05, limit_error = 0.0;                ///< share of the nearest limit that is left
  double thermal_warn = 0.7, thermal_error = 0.95;            ///< I2t share

  /// Throws InputError for what is no number, negative, or the wrong way round.
  static DiagnosticThresholds of(const ros::NodeHandle& node);
};

/// Diagnostics once a second by diagnostic_updater: machine, tracking, limits, motors, residual, timing, guardian,
/// recording, real time.
class ControllerDiagnostics {
 public:
  using Guardian = GuardianSupervision::Guardian;

  /// `node`: the private namespace, with a callback queue that one thread serves.
  ControllerDiagnostics(ros::NodeHandle& node, const control::ControlSystem& system, const mechanism::Robot& robot,
                        const std::atomic<Guardian>& guardian);

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  void poll();
  void machine(Status& status);
  void tracking(Status& status);
  void limits(Status& status);
  void motors(Status& status);
  void residual(Status& status);
  void timing(Status& status);
  void guardian(Status& status);
  void recording(Status& status);
  void realTime(Status& status);

  const control::ControlSystem& system_;
  const mechanism::Robot& robot_;
  const std::atomic<Guardian>& guardian_;
  const DiagnosticThresholds thresholds_;
  diagnostic_updater::Updater updater_;
  std::array<double, hardware::kAxes> largest_error_{};  // m, since the last update
  std::vector<rt::DurationHistogram::Snapshot> timing_before_;
  std::uint64_t missed_before_ = 0;
  mechanism::ForwardResult forward_;
  int polls_ = 0;
  ros::SteadyTimer timer_;
};

}  // namespace knee_robot::nodes
