#include "knee_robot/dynamics/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "knee_robot/base/numbers.h"

namespace knee_robot::dynamics {
namespace {

/// Tensor of a point mass 1 at `c`: |c|^2 E - c c^T (parallel-axis theorem).
mechanism::Matrix3 pointTensor(const mechanism::Vector3& c) {
  return c.squaredNorm() * mechanism::Matrix3::Identity() - c * c.transpose();
}

}  // namespace

LinkParameters toParameters(const LinkInertia& link) {
  const mechanism::Matrix3 about_origin = link.inertia + link.mass * pointTensor(link.center);
  LinkParameters p;
  p << about_origin(0, 0), about_origin(0, 1), about_origin(0, 2), about_origin(1, 1), about_origin(1, 2),
      about_origin(2, 2), link.mass * link.center, link.mass;
  return p;
}

LinkInertia fromParameters(const LinkParameters& p) {
  LinkInertia link;
  link.mass = p[9];
  link.center = p.segment<3>(6) / link.mass;
  mechanism::Matrix3 about_origin;
  about_origin << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  link.inertia = about_origin - link.mass * pointTensor(link.center);
  return link;
}

mechanism::Vector3 principalMoments(const LinkInertia& link) {
  return Eigen::SelfAdjointEigenSolver<mechanism::Matrix3>(link.inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string inconsistency(const LinkInertia& link) {
  if (!std::isfinite(link.mass) || !link.center.allFinite() || !link.inertia.allFinite()) {
    return "a value is not a finite number";
  }
  if (link.mass <= 0.0) return "mass " + shortNumber(link.mass) + " kg is not positive";
  const double size = link.inertia.norm();
  if ((link.inertia - link.inertia.transpose()).norm() > 1e-9 * size) return "the inertia tensor is not symmetric";
  const mechanism::Vector3 moments = principalMoments(link);
  const double rounding = 1e-9 * size;
  if (moments[0] < -rounding) return "principal moment " + shortNumber(moments[0]) + " kg m^2 is negative";
  if (moments[2] > moments[0] + moments[1] + rounding) {
    return "principal moment " + shortNumber(moments[2]) + " kg m^2 exceeds the sum of the two others, " +
           shortNumber(moments[0]) + " + " + shortNumber(moments[1]);
  }
  return {};
}

}  // namespace knee_robot::dynamics
