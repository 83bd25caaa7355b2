#pragma once

#include "knee_robot/dynamics/parameters.h"

namespace knee_robot::dynamics {

/// Force and moment (about the link frame's origin) of one rigid body as linear functions of its ten parameters;
/// everything in the body's frame. `a` is the origin's acceleration minus gravity.
struct BodyRegressor {
  Eigen::Matrix<double, 3, 6> moment_per_inertia;
  mechanism::Matrix3 moment_per_first_moment;  ///< -[a]x
  mechanism::Matrix3 force_per_first_moment;   ///< [alpha]x + [omega]x^2
  mechanism::Vector3 force_per_mass;           ///< a
};

inline BodyRegressor bodyRegressor(const mechanism::Vector3& w, const mechanism::Vector3& e,
                                   const mechanism::Vector3& a) {
  const double xx = w.x() * w.x(), yy = w.y() * w.y(), zz = w.z() * w.z();
  const double xy = w.x() * w.y(), xz = w.x() * w.z(), yz = w.y() * w.z();
  BodyRegressor r;
  // I e + w x (I w), column by column of [Ixx Ixy Ixz Iyy Iyz Izz].
  r.moment_per_inertia << e.x(), e.y() - xz, e.z() + xy, -yz, yy - zz, yz,  //
      xz, e.x() + yz, zz - xx, e.y(), e.z() - xy, -xz,                      //
      -xy, xx - yy, e.x() - yz, xy, e.y() + xz, e.z();
  r.moment_per_first_moment << 0.0, a.z(), -a.y(),  //
      -a.z(), 0.0, a.x(),                           //
      a.y(), -a.x(), 0.0;
  r.force_per_first_moment << -yy - zz, xy - e.z(), xz + e.y(),  //
      xy + e.z(), -xx - zz, yz - e.x(),                          //
      xz - e.y(), yz + e.x(), -xx - yy;
  r.force_per_mass = a;
  return r;
}

}  // namespace knee_robot::dynamics
