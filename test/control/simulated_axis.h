#pragma once

#include <cmath>
#include <deque>
#include <functional>

#include "knee_robot/control/pid.h"

namespace knee_robot::fake {

/// An axis of known inertia, friction and delay, moved on in small steps: nothing of the code that it tests.
struct SimulatedAxis {
  static constexpr double kStep_s = 20e-6;

  double mass_kg = 10.0, viscous = 0.0, coulomb_N = 0.0, delay_s = 0.0;
  double position = 0.0, velocity = 0.0;

  /// `force` from now on, for `time`; it arrives delay_s later.
  void advance(double force, double time) {
    const auto late = static_cast<std::size_t>(std::llround(delay_s / kStep_s));
    for (int k = 0; k < static_cast<int>(std::llround(time / kStep_s)); ++k) {
      under_way_.push_back(force);
      double arrived = 0.0;
      if (under_way_.size() > late) {
        arrived = under_way_.front();
        under_way_.pop_front();
      }
      move(arrived);
    }
  }

 private:
  void move(double force) {
    const double free = velocity + kStep_s / mass_kg * (force - viscous * velocity);
    const double brake = kStep_s / mass_kg * coulomb_N;
    const double before = velocity;
    velocity = std::abs(free) <= brake ? 0.0 : free - std::copysign(brake, free);
    position +=
        0.5 * kStep_s * (before + velocity);  // the new velocity alone would be half a step early: 2 % of a gain margin
  }
  std::deque<double> under_way_;
};

/// Largest |position| in the second half of `time_s` over that in the first half, after a small step of the reference:
/// beyond 1 the loop does not come to rest.
inline double growth(const control::PidGains& gains, SimulatedAxis axis, double period, double time_s) {
  control::Pid pid;
  pid.setGains(gains);
  pid.reset(0.0);
  const int cycles = static_cast<int>(time_s / period);
  double first = 1e-12, second = 0.0;
  for (int k = 0; k < cycles; ++k) {
    control::PidInput input;
    input.measured = axis.position;
    input.reference = k < 5 ? 1e-3 : 0.0;
    input.dt = period;
    axis.advance(pid.update(input, 1e12), period);
    double& largest = k < cycles / 2 ? first : second;
    if (k > cycles / 10) largest = std::max(largest, std::abs(axis.position));
    if (!(std::abs(axis.position) < 10.0)) return 1e6;  // long before the clamp makes it a limit cycle
  }
  return second / first;
}

}  // namespace knee_robot::fake
