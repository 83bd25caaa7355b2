#include "line.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kShortest_m = 1e-6;

}  // namespace

Line lineAt(const mechanism::Motion& motion, const Eigen::Vector4d& anchors, double base_z_m) noexcept {
  const mechanism::Pose& x = motion.pose;
  const mechanism::Matrix3 rotation = mechanism::platformRotation(x);
  const mechanism::Vector3 arm = anchors[2] * rotation.col(0) + anchors[3] * rotation.col(1);
  const mechanism::Vector3 span = mechanism::Vector3(x[0] - anchors[0], -anchors[1], x[1] - base_z_m) + arm;
  Line line;
  line.length_m = std::max(kShortest_m, span.norm());
  const mechanism::Vector3 direction = span / line.length_m;
  const mechanism::Vector3 by_psi = rotation.col(2).cross(arm);
  line.per_newton << direction[0], direction[2], direction[0] * arm[2] - direction[2] * arm[0], direction.dot(by_psi);
  line.rate_m_per_s = line.per_newton.dot(motion.pose_velocity);
  return line;
}

}  // namespace knee_robot::dynamics
