#pragma once

#include <cstdint>

namespace knee_robot::control {

/// What a monitor sees of one axis in one cycle. Monitors are small state machines of their own: step() answers whether
/// their limit is broken now, reset() forgets. Pure, real-time safe. What is not a number counts as broken, except for
/// StallMonitor and RunawayMonitor, which compare several of these: others see it first.
struct AxisView {
  double dt = 0.0;         ///< s since the last measurement, over skipped cycles too
  double moved_m = 0.0;    ///< by the encoder, since then
  bool after_gap = false;  ///< in between the encoders could not be read
  double position_m = 0.0;
  double velocity = 0.0;  ///< m/s, low-passed
  double reference_m = 0.0;
  double reference_velocity = 0.0;  ///< m/s
  double force_N = 0.0;             ///< written to the motor, after clamp, for the time that this measurement ends
  double force_limit_N = 0.0;       ///< clamp of the axis
  bool can_be_asked = false;        ///< its Driver can ask the encoder whether it counts
  std::uint32_t answers = 0;        ///< how often the encoder has answered
};

/// How long something has been true without a break.
class TrueFor {
 public:
  /// True when `condition` has held for at least `limit_s`, this cycle's dt included.
  bool step(bool condition, double dt, double limit_s) noexcept {
    time_s_ = condition ? time_s_ + dt : 0.0;
    return condition && time_s_ >= limit_s;
  }
  bool isTrue() const noexcept { return time_s_ > 0.0; }
  double time_s() const noexcept { return time_s_; }
  void reset() noexcept { time_s_ = 0.0; }

 private:
  double time_s_ = 0.0;
};

}  // namespace knee_robot::control
