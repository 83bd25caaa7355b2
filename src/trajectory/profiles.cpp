#include "knee_robot/trajectory/profiles.h"

#include <cmath>

namespace knee_robot::trajectory {

PointToPoint::PointToPoint(double distance, const ProfileLimits& limits) : distance_(distance), jerk_(limits.jerk) {
  const double d = std::abs(distance), v = limits.velocity, a = limits.acceleration, j = limits.jerk;
  if (d == 0.0) return;
  const bool reaches_acceleration = v * j >= a * a;
  jerk_time_ = reaches_acceleration ? a / j : std::sqrt(v / j);
  ramp_ = reaches_acceleration ? jerk_time_ + v / a : 2.0 * jerk_time_;
  cruise_ = d / v - ramp_;
  if (cruise_ >= 0.0) return;
  // Too short a way to reach the velocity; perhaps not even the acceleration.
  cruise_ = 0.0;
  if (d >= 2.0 * a * a * a / (j * j)) {
    jerk_time_ = a / j;
    ramp_ = 0.5 * jerk_time_ + std::sqrt(0.25 * jerk_time_ * jerk_time_ + d / a);
  } else {
    jerk_time_ = std::cbrt(0.5 * d / j);
    ramp_ = 2.0 * jerk_time_;
  }
}

/// Way, velocity and acceleration `time` after the start, while accelerating.
ProfilePoint PointToPoint::onRamp(double time) const {
  const double j = jerk_, tj = jerk_time_, a = j * tj;
  if (time < tj) return {j * time * time * time / 6.0, 0.5 * j * time * time, j * time};
  if (time < ramp_ - tj) {
    const double t = time - 0.5 * tj;
    return {0.5 * a * t * t + a * tj * tj / 24.0, a * t, a};
  }
  const double v = a * (ramp_ - tj), rest = ramp_ - time;
  return {0.5 * v * ramp_ - v * rest + j * rest * rest * rest / 6.0, v - 0.5 * j * rest * rest, j * rest};
}

ProfilePoint PointToPoint::at(double time) const {
  const double sign = distance_ < 0.0 ? -1.0 : 1.0, d = std::abs(distance_);
  if (time <= 0.0) return {};
  if (time >= duration()) return {distance_, 0.0, 0.0};
  ProfilePoint point;
  if (time < ramp_) {
    point = onRamp(time);
  } else if (time <= ramp_ + cruise_) {
    const ProfilePoint top = onRamp(ramp_);
    point = {top.position + top.velocity * (time - ramp_), top.velocity, 0.0};
  } else {
    const ProfilePoint mirrored = onRamp(duration() - time);
    point = {d - mirrored.position, mirrored.velocity, -mirrored.acceleration};
  }
  return {sign * point.position, sign * point.velocity, sign * point.acceleration};
}

}  // namespace knee_robot::trajectory
