#include "enabling_sequence.h"

#include <algorithm>

namespace knee_robot::control {

EnablingSequence::EnablingSequence(const HardwareFile& hardware)
    : drive_delay_s_(hardware.drive_enable_delay_s), hold_delay_s_(hardware.holdDelay()), brakes_(hardware) {}

void EnablingSequence::begin(rt::Nanoseconds now) noexcept {
  begun_ = now;
  order(DriveLevel::Energised, now);
}

/// The outputs may obey in the same cycle: what the level has to last counts from now, or from when they have it.
void EnablingSequence::order(DriveLevel level, rt::Nanoseconds now) noexcept {
  level_ = level;
  level_since_ = now;
}

EnablingSequence::Step EnablingSequence::step(const SupervisorView& view, const Settings& settings,
                                              rt::Nanoseconds now) noexcept {
  Step step;
  step.level = level_;
  if (now - begun_ > rt::fromSeconds(settings.limit_s)) {
    step.fault.fault = Fault::EnableTimeout;
    return step;
  }
  if (view.written.level != level_) level_since_ = now;
  const double elapsed = rt::toSeconds(now - level_since_);
  switch (view.written.level) {
    case DriveLevel::Off:
      break;
    case DriveLevel::Energised:
      if (elapsed < drive_delay_s_) {
        brakes_.standAt(view.measured.position_m);
      } else if (testBrakes(view, settings, elapsed - drive_delay_s_, step)) {
        order(DriveLevel::HeldByDrivers, now);
      }
      break;
    case DriveLevel::HeldByDrivers: {
      const auto carries = [](const AxisCommand& command) { return command.active && command.loaded; };
      const bool all_carry = std::all_of(view.commands.begin(), view.commands.end(), carries);
      if (!all_carry) level_since_ = now;
      if (all_carry && elapsed >= settings.settle_s) order(DriveLevel::Released, now);
      break;
    }
    case DriveLevel::Released:
      step.done = elapsed >= hold_delay_s_;
      break;
  }
  step.level = level_;
  return step;
}

/// True: all brakes hold.
bool EnablingSequence::testBrakes(const SupervisorView& view, const Settings& settings, double time_s,
                                  Step& step) noexcept {
  const BrakeTest::Step test =
      brakes_.step(time_s, view.measured.position_m, settings.brake_test_N, settings.brake_slip_m);
  step.brake_test_N = test.force_N;
  if (test.slipped != 0) step.fault = {Fault::HoldDeviceSlips, test.slipped};
  return test.done;
}

}  // namespace knee_robot::control
