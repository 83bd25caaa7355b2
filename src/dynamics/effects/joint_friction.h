#pragma once

#include "knee_robot/dynamics/passive_joints.h"
#include "laws.h"

namespace knee_robot::dynamics {

/// Friction of joints without motors.
class JointFriction : public EffectLaw {
 public:
  /// On the pose, per unit of the coefficients.
  using OnPose = void (*)(const PassiveJoints& joints, const mechanism::Vector4& pose_velocity,
                          const JointRestLaw& rest, double period_s, JointMemory& memory, PoseColumns& out);

  /// `shape`: a speed (rad/s), and the angle (rad) of bristles where there are any (JointRestLaw).
  JointFriction(OnPose on_pose, int count, const Shape& shape)
      : on_pose_(on_pose), count_(count), rest_{shape[0], shape.size() > 1 ? shape[1] : 0.0} {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return count_; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    PassiveJoints joints;
    passiveJoints(*at.mechanism, *at.motion, joints);
    on_pose_(joints, at.motion->pose_velocity, rest_, at.period_s, state.of_joints, out);
  }

 private:
  const OnPose on_pose_;
  const int count_;
  const JointRestLaw rest_;
};

}  // namespace knee_robot::dynamics
