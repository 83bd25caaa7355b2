#pragma once

#include "knee_robot/dynamics/regressor.h"

namespace knee_robot::excitation {

using PaperRegressor = Eigen::Matrix<double, mechanism::kLegs, dynamics::kPaperParameters>;

/// What the actuators are expected to have to push: parameters of eq. (28), and the drives' rotors.
struct ExpectedLoad {
  dynamics::PaperParameters parameters = dynamics::PaperParameters::Zero();
  mechanism::Vector4 rotor_mass = mechanism::Vector4::Zero();  ///< kg, per actuator
};

/// Rows of InstantSlopes.
namespace slope_row {
inline constexpr int kObservation = 0;  ///< sum of weights times elements of K*
inline constexpr int kBaseCosine = 1;   ///< 4: cosine of the angle between leg and base Z
inline constexpr int kTipCosine = 5;    ///< 3: cosine of the angle between leg and platform normal, legs 1 to 3
inline constexpr int kCondition = 8;    ///< log of the condition number of dq/dx
inline constexpr int kForce = 9;        ///< 4: expected actuator forces, N
inline constexpr int kRows = 13;
}  // namespace slope_row

/// Values at one instant with their exact slopes by lengths, velocities and accelerations of the four actuators (12
/// columns).
struct InstantSlopes {
  Eigen::Matrix<double, slope_row::kRows, 1> value;
  Eigen::Matrix<double, slope_row::kRows, 3 * mechanism::kLegs> slope;
};

/// Dual numbers (ceres::Jet) carry the derivatives by pose, pose velocity and pose acceleration through kinematics and
/// Newton-Euler; the lengths' own derivatives by these turn them into derivatives by the actuators, so that the Newton
/// iteration of the forward kinematics is never differentiated. `regressor` is K*(motion) with the same width,
/// `weights` what its elements are multiplied with. `motion` must not be singular.
InstantSlopes instantSlopes(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                            const mechanism::Motion& motion, const dynamics::CoulombWidth& width,
                            const PaperRegressor& regressor, const PaperRegressor& weights, const ExpectedLoad& load);

}  // namespace knee_robot::excitation
