#pragma once

#include <Eigen/Core>
#include <array>

namespace knee_robot::mechanism {

using Vector3 = Eigen::Vector3d;
using Vector4 = Eigen::Vector4d;
using Matrix3 = Eigen::Matrix3d;
using Matrix4 = Eigen::Matrix4d;

/// Number of legs, of actuated prismatic joints (q13, q23, q33, q42) and of platform coordinates (Xm, Zm, theta, psi).
inline constexpr int kLegs = 4;

/// Dimensions of the 3UPS+1RPU mechanism (paper, Table 1 and Fig. 7). Lengths in m, angles in rad.
struct Geometry {
  std::array<double, 3> R{};   ///< radii of the base joints of legs 1 to 3
  double ds = 0.0;             ///< X of the base joint of leg 4
  double beta_FD = 0.0;        ///< angle of base joint 2, from +X towards +Y
  double beta_FI = 0.0;        ///< angle of base joint 3, from +X towards -Y
  std::array<double, 3> Rm{};  ///< radii of the platform joints of legs 1 to 3
  double beta_MD = 0.0;        ///< angle of platform joint 2, from +X towards +Y
  double beta_MI = 0.0;        ///< angle of platform joint 3, from +X towards -Y
};

/// The mechanism as constants that every kinematic function needs: joint centres in their own frames (m).
/// Base frame: Z up. Platform frame: origin at the platform joint of leg 4.
struct Mechanism {
  explicit Mechanism(const Geometry& geometry);

  Geometry geometry;
  std::array<Vector3, kLegs> base_points;      ///< A0, B0, C0 and leg 4's (ds, 0, 0), base frame
  std::array<Vector3, kLegs> platform_points;  ///< A, B, C and (0, 0, 0), platform frame
};

}  // namespace knee_robot::mechanism
