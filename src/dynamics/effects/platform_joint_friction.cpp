#include "knee_robot/dynamics/platform_joints.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Friction of the joints between legs and platform.
class PlatformJointFriction : public EffectLaw {
 public:
  explicit PlatformJointFriction(const Shape& shape) : slow_rad_per_s_(shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return kPlatformJointColumns; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion,
                   PoseColumns& out) const noexcept override {
    PlatformJoints joints;
    platformJoints(mechanism, motion, joints);
    platformJointColumns(joints, motion.pose_velocity, slow_rad_per_s_, out);
  }

 private:
  const double slow_rad_per_s_;
};

}  // namespace

Law platformJointFrictionLaw(const Shape& shape) {
  return std::make_unique<PlatformJointFriction>(shape);
}

}  // namespace knee_robot::dynamics
