#include "link.h"

namespace knee_robot::simulation {

Link::Link(StrictMap& entry)
    : anchor_m_(readVector3(entry, "anchor_m", -10.0, 10.0)), point_m_(readVector3(entry, "point_m", -2.0, 2.0)) {}

double Link::rate(const EffectStep& at) const noexcept {
  return -pull(at.pose, 1.0).dot(at.pose_velocity);
}

mechanism::Vector4 Link::pull(const mechanism::Pose& pose, double force_N) const noexcept {
  const mechanism::Vector3 span = platformPoint(pose, point_m_) - anchor_m_;
  return poseForceOf(pose, point_m_, -force_N * span.normalized());  // nothing at no length: it has no direction
}

}  // namespace knee_robot::simulation
