#pragma once

#include <array>

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// Whether the other axes feel a test pulse. An encoder that does not count under force is dead, or its axis is blocked
/// (a closed brake, an obstacle), or its drive gives no force: by itself an axis cannot tell. But an axis that moves
/// shakes the platform, and with it the axes whose encoders count; a blocked one, or one without force, does not.
///
/// The force of the pulse, integrated twice, is how a free mass would move. What the errors of the other axes have in
/// common with that, beside a parabola in time (they are on their own ways), is their answer: Yes when it is more than
/// kCounts counts and kSure times its standard error in one of them, No when it is below kCounts counts or kQuiet times
/// that in all, Unknown otherwise. Those that get pulses of their own are not asked, and fewer than kWitnesses never
/// say no. One an axis; real-time safe.
class PulseWitness {
 public:
  static constexpr std::size_t kMost = 48;     // samples
  static constexpr double kLeast_s = 0.016;    // of pulse
  static constexpr double kAfter_s = 0.012;    // without a pulse, until the next one is another
  static constexpr double kForeign_s = 0.012;  // after a pulse of another axis this moves by itself
  static constexpr double kCounts = 0.7;
  static constexpr double kSure = 4.0;
  static constexpr double kQuiet = 3.0;
  static constexpr int kWitnesses = 2;

  void reset() noexcept { *this = PulseWitness{}; }

  /// One cycle of `dt`. `pulses_N`: of all axes, in the cycle before; `error_m`: reference less position; `count_m`:
  /// what a count is.
  void step(std::size_t axis, double dt, const AxisValues& pulses_N, const AxisValues& error_m) noexcept;
  Felt felt(std::size_t axis, const AxisValues& count_m) const noexcept;

  /// Movement that goes with a pulse, m, and its standard deviation.
  struct Answer {
    double way_m = 0.0, sigma_m = 0.0;
  };
  /// How far axis `other` moves with the pulse.
  Answer answerOf(std::size_t other, double count_m) const noexcept;

 private:
  std::size_t samples_ = 0;
  double pulse_s_ = 0.0, quiet_s_ = 1.0;
  double speed_ = 0.0, way_ = 0.0;                                   // of a free mass of 1 kg
  std::array<double, hardware::kAxes> own_s_{{1.0, 1.0, 1.0, 1.0}};  // since each axis got a pulse
  std::array<bool, hardware::kAxes> foreign_{};
  std::array<double, kMost> ways_{};
  std::array<AxisValues, kMost> errors_{};
};

}  // namespace knee_robot::control
