#pragma once

#include <string>
#include <vector>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// The last shape parameter of friction in joints: 0 where it is smooth, as in model files that lack it.
ShapeParameter jointBristleParameter();

/// Coulomb and viscous friction of joints without motors, which acts on the pose. Near rest Coulomb friction is
/// proportional to the rate below a speed, or bends bristles over an angle.
class JointFriction : public Candidate {
 public:
  /// Per unit of the coefficients, on the pose (dynamics::platformJointColumns and the like), `count` columns.
  using OnPose = void (*)(const dynamics::PassiveJoints& joints, const mechanism::Vector4& pose_velocity,
                          const dynamics::JointRestLaw& rest, double period_s, dynamics::JointMemory& memory,
                          dynamics::PoseColumns& out);

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
