#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::dynamics {

/// Links in the paper's order: (leg, 1) cylinder and (leg, 2) rod of legs 1 to 4, then the platform.
///
/// Link frames (modified Denavit-Hartenberg; with them the paper's Table 2 comes out):
///  - cylinder (i, 1): origin in the base joint, z along the axis n of the joint next to it, y along the leg, x = y x
///  z;
///  - rod (i, 2): origin in the platform joint (the leg's tip), z along the leg, x as the cylinder's, y = z x x;
///  - platform: eq. (5), origin in the joint of leg 4.
inline constexpr int kLinks = 9;
inline constexpr int kPlatformLink = 8;
constexpr int cylinderLink(int leg) {
  return 2 * leg;
}
constexpr int rodLink(int leg) {
  return 2 * leg + 1;
}

/// Ten inertial parameters a link: [Ixx Ixy Ixz Iyy Iyz Izz mx my mz m], inertia tensor (kg m^2) and first moments (kg
/// m) about the link frame's origin. Ixy, Ixz, Iyz are the tensor's elements (minus the products of inertia).
inline constexpr int kLinkParameters = 10;
inline constexpr int kInertialParameters = kLinks * kLinkParameters;  // 90

/// Viscous (N s/m, N m s/rad) and Coulomb (N, N m) friction of every leg joint, order of eq. (22): leg by leg, joints
/// counted down: Fv_13 Fc_13 Fv_12 Fc_12 Fv_11 Fc_11, ..., Fv_42 Fc_42 Fv_41 Fc_41.
inline constexpr int kFrictionParameters = 22;
/// Columns of the paper's K*.
inline constexpr int kPaperParameters = kInertialParameters + kFrictionParameters;  // 112

/// What identification works with: the paper's parameters in blocks, and what the paper leaves out.
/// [rigid 90 | passive friction 14 | actuator viscous 4 | actuator Coulomb 4 | rotor 4 | offset 4]
/// Passive friction keeps the paper's order: Fv_12 Fc_12 Fv_11 Fc_11 ... Fv_41 Fc_41. Rotor: motor and screw inertia
/// reflected to the actuator, kg. Offset: constant force, N.
namespace extended {
inline constexpr int kPassiveFriction = dynamics::kInertialParameters;  // first column of each block
inline constexpr int kPassiveFrictionCount = 14;
inline constexpr int kViscous = kPassiveFriction + kPassiveFrictionCount;
inline constexpr int kCoulomb = kViscous + mechanism::kLegs;
inline constexpr int kRotor = kCoulomb + mechanism::kLegs;
inline constexpr int kOffset = kRotor + mechanism::kLegs;
inline constexpr int kParameters = kOffset + mechanism::kLegs;  // 120
}  // namespace extended

using LinkParameters = Eigen::Matrix<double, kLinkParameters, 1>;
using InertialParameters = Eigen::Matrix<double, kInertialParameters, 1>;
using FrictionParameters = Eigen::Matrix<double, kFrictionParameters, 1>;
using PaperParameters = Eigen::Matrix<double, kPaperParameters, 1>;
using ExtendedParameters = Eigen::Matrix<double, extended::kParameters, 1>;

/// Names as in the paper's Table 2: IXX_41, mY_42, m_11; the platform is M: IXX_M. Friction: Fv_13, Fc_13.
const std::vector<std::string>& inertialParameterNames();
const std::vector<std::string>& frictionParameterNames();
/// The 112 of K*: inertial, then friction.
const std::vector<std::string>& paperParameterNames();
/// The 120 extended ones; rotor_1, offset_1 (per actuator).
const std::vector<std::string>& extendedParameterNames();
/// "leg_1_cylinder", "leg_1_rod", ..., "platform": the links' names in the URDF.
const std::vector<std::string>& linkNames();

/// The 112 paper parameters as extended ones, rotor and offset zero: the check that both regressors say the same.
ExtendedParameters toExtended(const PaperParameters& parameters);

}  // namespace knee_robot::dynamics
