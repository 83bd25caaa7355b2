#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "knee_robot/hardware/axis_bus.h"

namespace knee_robot::control {

/// Notices that something disturbs a robot that stands. An axis that nobody touches sticks where it is, or slips
/// towards its reference.
/// Whatever reaches the platform and is more than one axis' friction takes that axis away from its reference. An axis
/// whose encoder is dead gives way without a trace, but it seldom is the only one that is reached: so each disturbance
/// is the moment to ask every encoder (EncoderChallenge), and without one nobody is asked.
///
/// Disturbed: an axis is kAway counts (and kWay_m) farther from its reference than it was, or kSlip counts away from
/// where it was; within kQuiet_s of a test pulse, kPulsed counts and kPulsed_m. What was follows within kFollow_s.
/// Pure, one for the robot, real-time safe.
class RestWatch {
 public:
  static constexpr double kSettle_s = 0.3;  // of rest before it looks; the last slips after a motion are over
  static constexpr double kQuiet_s = 0.06;  // after a test pulse of any axis
  static constexpr double kAgain_s = 0.3;   // between two disturbances: one that goes on is asked about once
  static constexpr double kFollow_s = 1.0;  // time constant
  static constexpr double kAway = 1.6;      // counts
  static constexpr double kSlip = 4.6;      // counts: more than a slip towards the reference usually has
  static constexpr double kWay_m = 8e-6;
  static constexpr double kPulsed = 9.6;  // counts: more than a test pulse moves an axis
  static constexpr double kPulsed_m = 1.5e-4;

  using Axes = std::array<double, hardware::kAxes>;

  void reset() noexcept { settle_s_ = kSettle_s; }

  /// One cycle of `dt`. `rests`: all references stand and the loops alone carry; `pulses`: an axis gets a test pulse.
  /// `error_m`:
  /// reference less position; `count_m`: what a count is.
  bool step(bool rests, bool pulses, double dt, const Axes& error_m, const Axes& count_m) noexcept {
    settle_s_ = rests ? std::max(0.0, settle_s_ - dt) : kSettle_s;
    if (settle_s_ > 0.0) {
      was_m_ = error_m;
      quiet_s_ = 0.0;
      return false;
    }
    const bool pulsed = pulses || quiet_s_ > 0.0;
    bool disturbed = false;
    for (std::size_t i = 0; i < error_m.size(); ++i) {
      disturbed = disturbed || !stands(pulsed, error_m[i], was_m_[i], count_m[i]);
      if (!pulsed) was_m_[i] += std::min(1.0, dt / kFollow_s) * (error_m[i] - was_m_[i]);
    }
    quiet_s_ = pulses || disturbed ? kQuiet_s : quiet_s_ - dt;
    if (disturbed || (pulsed && quiet_s_ <= 0.0)) was_m_ = error_m;
    since_s_ += dt;
    if (!disturbed || since_s_ < kAgain_s) return false;
    since_s_ = 0.0;
    return true;
  }

 private:
  static bool stands(bool pulsed, double error_m, double was_m, double count_m) noexcept {
    const double away = std::abs(error_m) - std::abs(was_m);
    const double slip = std::abs(error_m - was_m);
    if (pulsed) return slip < std::max(kPulsed * count_m, kPulsed_m);
    return away < std::max(kAway * count_m, kWay_m) && slip < std::max(kSlip * count_m, kWay_m);
  }

  double settle_s_ = kSettle_s, quiet_s_ = 0.0, since_s_ = kAgain_s;
  Axes was_m_{};  // errors
};

}  // namespace knee_robot::control
