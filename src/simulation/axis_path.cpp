#include "knee_robot/simulation/axis_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace knee_robot::simulation {

AxisPath::AxisPath(const Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs>& points, double period_s)
    : points_(points), curvature_(points.rows(), mechanism::kLegs), period_s_(period_s) {
  // Clamped cubic spline: M[k-1] + 4 M[k] + M[k+1] = 6 / h^2 (p[k-1] - 2 p[k] + p[k+1]), at the ends 2 M[0] + M[1] =
  // 6 / h^2 (p[1] - p[0]); solved by elimination and back substitution.
  const Eigen::Index last = points.rows() - 1;
  const double factor = 6.0 / (period_s * period_s);
  std::vector<double> above(static_cast<std::size_t>(points.rows()));
  curvature_.row(0) = 0.5 * factor * (points.row(1) - points.row(0));
  above[0] = 0.5;
  for (Eigen::Index k = 1; k <= last; ++k) {
    const bool inner = k < last;
    const Eigen::RowVector4d right =
        inner ? Eigen::RowVector4d(points.row(k - 1) - 2.0 * points.row(k) + points.row(k + 1))
              : Eigen::RowVector4d(points.row(k - 1) - points.row(k));
    const double pivot = (inner ? 4.0 : 2.0) - above[static_cast<std::size_t>(k - 1)];
    above[static_cast<std::size_t>(k)] = 1.0 / pivot;
    curvature_.row(k) = (factor * right - curvature_.row(k - 1)) / pivot;
  }
  for (Eigen::Index k = last - 1; k >= 0; --k)
    curvature_.row(k) -= above[static_cast<std::size_t>(k)] * curvature_.row(k + 1);
}

AxisMotion AxisPath::at(double time_s) const {
  AxisMotion motion;
  if (time_s <= 0.0 || time_s >= duration()) {
    motion.position = points_.row(time_s <= 0.0 ? 0 : points_.rows() - 1).transpose();
    return motion;
  }
  const double h = period_s_;
  const Eigen::Index k =
      std::min(static_cast<Eigen::Index>(std::floor(time_s / h)), static_cast<Eigen::Index>(points_.rows() - 2));
  const double b = time_s / h - static_cast<double>(k);
  const double a = 1.0 - b;
  const mechanism::Vector4 p0 = points_.row(k).transpose(), p1 = points_.row(k + 1).transpose();
  const mechanism::Vector4 m0 = curvature_.row(k).transpose(), m1 = curvature_.row(k + 1).transpose();
  motion.position = a * p0 + b * p1 + h * h / 6.0 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
  motion.velocity = (p1 - p0) / h + h / 6.0 * ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0);
  motion.acceleration = a * m0 + b * m1;
  return motion;
}

}  // namespace knee_robot::simulation
