#pragma once

#include <algorithm>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// Velocity of a point of the platform by the rates of the pose (x, z, theta, psi); `arm`: from the platform's origin to
/// it, base frame, m.
Eigen::Matrix<double, 3, 4> velocityByPose(const mechanism::Matrix3& rotation, const mechanism::Vector3& arm);

/// What x'' + 2 d w x' + w^2 x = 0 makes of (x, x') within `period_s`, exactly; `omega` = w in rad/s, `damping` = d below 1.
Eigen::Matrix2d oscillationStep(double omega, double damping, double period_s);

/// `shape` with each number in turn moved by `step` to either side, within `bounds`; `moved(k, value, side)` is number k
/// then.
template <typename Moved>
std::vector<std::vector<double>> besideEach(const std::vector<double>& shape, double step,
                                            const std::vector<ShapeParameter>& bounds, const Moved& moved) {
  std::vector<std::vector<double>> out;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    for (const double side : {-step, step}) {
      out.push_back(shape);
      out.back()[k] = std::clamp(moved(k, shape[k], side), bounds[k].low, bounds[k].high);
    }
  }
  return out;
}

/// A force on the platform in proportion to one coefficient: all actuators together bear it.
class OnPlatform : public Candidate {
 public:
  bool shared() const override { return true; }
  bool restsOnModel() const override { return false; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;
  std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& input, const std::vector<double>& shape) const override;

 protected:
  /// What the actuators have to give for one unit of the coefficient, as a force on the pose: x, z in N, theta, psi in
  /// N m; one column a sample.
  virtual Eigen::Matrix4Xd onPose(const EffectInput& input, const std::vector<double>& shape) const = 0;
};

}  // namespace knee_robot::tracing
