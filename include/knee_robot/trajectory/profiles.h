#pragma once

namespace knee_robot::trajectory {

/// Bounds of a movement along one coordinate, all positive; SI units of that coordinate (m or rad, per s, s^2, s^3).
struct ProfileLimits {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

/// Position, velocity and acceleration along the coordinate.
struct ProfilePoint {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// Fastest movement from rest to rest over a distance under bounds of velocity, acceleration and jerk: the seven-phase
/// "double S" (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, sect. 3.4). Chosen over
/// a quintic because an exercise has a speed: the double S holds exactly that speed in between, while a quintic only
/// passes it once.
class PointToPoint {
 public:
  /// `distance` may be negative or zero.
  PointToPoint(double distance, const ProfileLimits& limits);

  double duration() const { return 2.0 * ramp_ + cruise_; }
  /// At rest in 0 before the start and in `distance` after the end.
  ProfilePoint at(double time) const;

 private:
  ProfilePoint onRamp(double time) const;

  double distance_;
  double jerk_time_ = 0.0;  ///< of each of the four phases with jerk
  double ramp_ = 0.0;       ///< duration of the acceleration, jerk phases included
  double cruise_ = 0.0;     ///< duration at constant velocity
  double jerk_ = 0.0;
};

}  // namespace knee_robot::trajectory
