#pragma once

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {

/// The straight line between a point of the base (base frame) and one of the platform (platform frame): keys anchor_m
/// and point_m of an effect's entry.
class Link {
 public:
  explicit Link(StrictMap& entry);

  /// At which it becomes longer (m/s).
  double rate(const EffectStep& at) const noexcept;
  /// Generalized force on the pose when the line pulls with `force_N`.
  mechanism::Vector4 pull(const mechanism::Pose& pose, double force_N) const noexcept;

 private:
  mechanism::Vector3 anchor_m_;
  mechanism::Vector3 point_m_;
};

}  // namespace knee_robot::simulation
