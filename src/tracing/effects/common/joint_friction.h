#pragma once

#include <string>
#include <vector>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// Coulomb and viscous friction of joints without motors, which acts on the pose; Coulomb friction is proportional to
/// the rate below a speed.
class JointFriction : public Candidate {
 public:
  /// Per unit of the coefficients, on the pose (dynamics::platformJointColumns and the like), `count` columns.
  using OnPose = void (*)(const dynamics::PassiveJoints& joints, const mechanism::Vector4& pose_velocity,
                          double slow_rad_per_s, dynamics::PoseColumns& out);

  JointFriction(OnPose on_pose, int count) : on_pose_(on_pose), count_(count) {}
  bool restsOnModel() const override { return false; }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override;
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;

 private:
  OnPose on_pose_;
  int count_;
};

}  // namespace knee_robot::tracing
