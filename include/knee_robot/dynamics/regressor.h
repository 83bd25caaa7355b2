#pragma once

#include <array>

#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::dynamics {

/// Width of tanh(v / width) in place of sign(v) in the Coulomb columns. 0: the sign itself, sign(0) = 0.
struct CoulombWidth {
  double linear_m_per_s = 0.0;     ///< prismatic joints
  double angular_rad_per_s = 0.0;  ///< revolute and universal joints
};

/// Workspace and results of the regressor functions. Fixed size: make one and keep it.
struct RegressorData {
  using LegBlock = Eigen::Matrix<double, 3, 2 * kLinkParameters>;
  using PlatformBlock = Eigen::Matrix<double, 4, kLinkParameters>;

  mechanism::RobotMotion motion;
  mechanism::Matrix4 pose_per_length;          ///< J^-1 = dx/dq
  std::array<LegBlock, mechanism::kLegs> leg;  ///< K_P1..K_P4: rows q1, q2, q3 (leg 4: row q1 zero), cylinder | rod
  PlatformBlock platform;                      ///< K_PM: rows Xm, Zm, theta, psi
  std::array<mechanism::Matrix34, mechanism::kLegs> joints_per_length;  ///< d(q1, q2, q3)/d(q13, q23, q33, q42)
  Eigen::Matrix<double, mechanism::kLegs, kPaperParameters> k;          ///< K*, eq. (28)
};

/// K*(motion), 4 x 112, eq. (17)-(29): actuator forces (N) = data.k * Phi, gravity included. Projection through the
/// pose coordinates; it equals the paper's K_i - X^T K_d. False when J is singular to working precision; data.k is then
/// undefined. Real-time safe.
bool projectedRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                        const mechanism::Motion& motion, RegressorData& data, const CoulombWidth& width = {});

using ExtendedRegressor = Eigen::Matrix<double, mechanism::kLegs, extended::kParameters>;

/// The same in the block order of parameters.h, with rotor and offset columns: actuator forces = result *
/// ExtendedParameters. Uses projectedRegressor; real-time safe.
bool extendedRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                       const mechanism::Motion& motion, RegressorData& data, ExtendedRegressor& result,
                       const CoulombWidth& width = {});

/// Only what belongs to the actuators, for a bench of axes too: [v | sign(v) | acceleration | 1] of one actuator.
mechanism::Vector4 actuatorRegressor(double velocity, double acceleration, double coulomb_width_m_per_s = 0.0);

// The paper's way to K*, by these two and X of eq. (19): used as an independent check of projectedRegressor().

/// K1, 15 x 90, eq. (18), of the robot opened into four legs and a free platform; rows in the order of eq. (14):
/// q13 q12 q11 q23 q22 q21 q33 q32 q31 q42 q41 psi theta Zm Xm. Motion must be consistent with the constraints.
using TreeRegressor = Eigen::Matrix<double, 15, kInertialParameters>;
void treeRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                   const mechanism::Motion& motion, RegressorData& data, TreeRegressor& result);

/// K1f, 15 x 22, eq. (23), same rows.
using TreeFrictionRegressor = Eigen::Matrix<double, 15, kFrictionParameters>;
void treeFrictionRegressor(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion, RegressorData& data,
                           TreeFrictionRegressor& result, const CoulombWidth& width = {});

}  // namespace knee_robot::dynamics
