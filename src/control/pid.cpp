#include "knee_robot/control/pid.h"

#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::control {
namespace {

/// Lets nan through, unlike std::clamp's formulation with min and max.
double clampKeepingNan(double value, double limit) noexcept {
  if (value > limit) return limit;
  if (value < -limit) return -limit;
  return value;
}

}  // namespace

void Pid::reset(double measured) noexcept {
  integral_ = 0.0;
  velocity_ = 0.0;
  last_measured_ = measured;
}

void Pid::changeGains(const PidGains& gains, const PidInput& input) noexcept {
  if (gains == gains_) return;
  const double error = input.reference - input.measured;
  const double speed_error = input.reference_velocity - velocity_;
  const double before = gains_.proportional * error + gains_.derivative * speed_error;
  const double after = gains.proportional * error + gains.derivative * speed_error;
  integral_ = clampKeepingNan(integral_ + before - after, last_limit_);
  gains_ = gains;
}

void Pid::shiftIntegral(double step) noexcept {
  integral_ = clampKeepingNan(integral_ + step, last_limit_);
}

void Pid::filterVelocity(const PidInput& input) noexcept {
  if (!(input.dt > 0.0)) return;
  const double tau = 1.0 / (kTwoPi * gains_.derivative_cutoff_hz);
  velocity_ += ((input.measured - last_measured_) / input.dt - velocity_) * input.dt / (tau + input.dt);
  last_measured_ = input.measured;
}

double Pid::follow(const PidInput& input) noexcept {
  filterVelocity(input);
  return integral_ + input.feedforward;
}

double Pid::update(const PidInput& input, double limit) noexcept {
  last_limit_ = limit;
  filterVelocity(input);
  const double error = input.reference - input.measured;
  const double others =
      gains_.proportional * error + gains_.derivative * (input.reference_velocity - velocity_) + input.feedforward;
  const double seen =
      std::abs(error) <= input.integral_dead_band ? 0.0 : error - std::copysign(input.integral_dead_band, error);
  const double increment = gains_.integral * seen * input.dt;
  const double unclamped = others + integral_ + increment;
  const bool winds_up = (unclamped > limit && increment > 0.0) || (unclamped < -limit && increment < 0.0);
  if (!winds_up) integral_ = clampKeepingNan(integral_ + increment, limit);
  return clampKeepingNan(others + integral_, limit);
}

}  // namespace knee_robot::control
