#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

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
