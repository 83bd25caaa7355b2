#pragma once

#include "brake_test.h"
#include "fault_latch.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// From drives that are off to Drivers that carry the platform, level by level:
///
///     Energised --drives' delay, brakes hold--> HeldByDrivers --loops closed, feedforward complete, for settle_s-->
///     Released --holding brakes' delay--> done
///
/// A level counts from when AxesOutput has written it. Pure, real-time safe.
class EnablingSequence {
 public:
  /// Times and the brake test, from the deployment file.
  struct Settings {
    double limit_s = 2.0;       ///< longest enabling
    double settle_s = 0.05;     ///< closed loops before the release
    double brake_test_N = 0.0;  ///< 0: brakes are not tested
    double brake_slip_m = 5e-4;
  };
  /// What one cycle of enabling asks for.
  struct Step {
    DriveLevel level = DriveLevel::Energised;  ///< to be ordered
    AxisValues brake_test_N{};
    FaultCause fault;
    bool done = false;
  };

  explicit EnablingSequence(const HardwareFile& hardware);

  /// Begins at Energised.
  void begin(rt::Nanoseconds now) noexcept;
  /// One cycle.
  Step step(const SupervisorView& view, const Settings& settings, rt::Nanoseconds now) noexcept;
  const BrakeTest& brakes() const noexcept { return brakes_; }

 private:
  void order(DriveLevel level, rt::Nanoseconds now) noexcept;
  bool testBrakes(const SupervisorView& view, const Settings& settings, double time_s, Step& step) noexcept;

  const double drive_delay_s_, hold_delay_s_;
  BrakeTest brakes_;
  DriveLevel level_ = DriveLevel::Energised;
  rt::Nanoseconds begun_ = 0;
  rt::Nanoseconds level_since_ = 0;
};

}  // namespace knee_robot::control
