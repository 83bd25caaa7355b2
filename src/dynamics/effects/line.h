#pragma once

#include "laws.h"

namespace knee_robot::dynamics {

constexpr double kSlow_m_per_s = 1e-3;  ///< of a damper: below it the force is proportional to the rate

/// A straight line from a point of the base to a point of the platform.
struct Line {
  double length_m = 0.0, rate_m_per_s = 0.0;
  mechanism::Vector4 per_newton =
      mechanism::Vector4::Zero();  ///< generalized force that lengthens it, per newton along it
};

/// `anchors`: X and Y of the base point (base frame) and of the platform point (platform frame), which is at height 0.
Line lineAt(const mechanism::Motion& motion, const Eigen::Vector4d& anchors, double base_z_m = 0.0) noexcept;

}  // namespace knee_robot::dynamics
