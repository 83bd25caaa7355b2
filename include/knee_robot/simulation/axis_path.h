#pragma once

#include <Eigen/Core>

#include "knee_robot/simulation/simbody_robot.h"

namespace knee_robot::simulation {

/// A smooth motion of the four actuators through points at equal intervals: the cubic spline that is at rest at both
/// ends (position, velocity and acceleration continuous). The first point is at time 0.
class AxisPath {
 public:
  /// `points`: at least 2 x 4, m. `period_s` positive.
  AxisPath(const Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs>& points, double period_s);

  double duration() const { return period_s_ * static_cast<double>(points_.rows() - 1); }
  /// Before the start and after the end: at rest in the first and last point.
  AxisMotion at(double time_s) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> points_;
  Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> curvature_;  ///< second derivative at the points, m/s^2
  double period_s_;
};

}  // namespace knee_robot::simulation
