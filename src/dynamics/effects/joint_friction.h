#pragma once

#include "knee_robot/dynamics/passive_joints.h"
#include "laws.h"

namespace knee_robot::dynamics {

/// Friction of joints without motors.
class JointFriction : public EffectLaw {
 public:
  /// On the pose, per unit of the coefficients.
  using OnPose = void (*)(const PassiveJoints& joints, const mechanism::Vector4& pose_velocity, double slow_rad_per_s,
                          PoseColumns& out);

  JointFriction(OnPose on_pose, int count, const Shape& shape)
      : on_pose_(on_pose), count_(count), slow_rad_per_s_(shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return count_; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion,
                   PoseColumns& out) const noexcept override {
    PassiveJoints joints;
    passiveJoints(mechanism, motion, joints);
    on_pose_(joints, motion.pose_velocity, slow_rad_per_s_, out);
  }

 private:
  const OnPose on_pose_;
  const int count_;
  const double slow_rad_per_s_;
};

}  // namespace knee_robot::dynamics
