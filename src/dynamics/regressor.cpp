#include "knee_robot/dynamics/regressor.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "body_regressor.h"

namespace knee_robot::dynamics {
namespace {

using Row10 = Eigen::Matrix<double, 1, kLinkParameters>;

/// Row of a generalized coordinate along which the body turns by `axis` and its origin moves by `travel` per unit.
template <typename Row>
void projectBody(const knee_robot::dynamics::BodyRegressor& body, const knee_robot::mechanism::Vector3& axis,
                 const knee_robot::mechanism::Vector3& travel, Row&& row) {
  row.template head<6>().noalias() = axis.transpose() * body.moment_per_inertia;
  row.template segment<3>(6).noalias() =
      axis.transpose() * body.moment_per_first_moment + travel.transpose() * body.force_per_first_moment;
  row[9] = travel.dot(body.force_per_mass);
}

/// Angular velocity and acceleration of a leg in its basis (-t, u, n).
struct LegTurning {
  explicit LegTurning(const mechanism::LegMotion& leg) {
    const double c2 = leg.cos_q2, s2 = leg.sin_q2;
    const mechanism::Vector3 &v = leg.rate, &a = leg.acceleration;
    omega = mechanism::Vector3(c2 * v[0], -s2 * v[0], v[1]);
    alpha = mechanism::Vector3(c2 * a[0] - s2 * v[0] * v[1], -s2 * a[0] - c2 * v[0] * v[1], a[1]);
  }
  mechanism::Vector3 omega, alpha;
};

mechanism::Vector3 toLegBasis(const mechanism::LegMotion& leg, const mechanism::Vector3& v) {
  return {-leg.t.dot(v), leg.u.dot(v), leg.n.dot(v)};
}
/// From the leg basis, which is the cylinder's frame, into the rod's.
mechanism::Vector3 toRodFrame(const mechanism::Vector3& v) {
  return {v.x(), -v.z(), v.y()};
}

/// K_Pi: rows q1, q2, q3; columns cylinder | rod.
void legBlock(const mechanism::LegMotion& leg, const mechanism::Vector3& gravity, bool has_q1,
              RegressorData::LegBlock& block) {
  const LegTurning turning(leg);
  const mechanism::Vector3 axis1(leg.cos_q2, -leg.sin_q2, 0.0), axis2 = mechanism::Vector3::UnitZ(),
                                                                still = mechanism::Vector3::Zero();
  const double length = leg.length;
  const BodyRegressor cylinder = bodyRegressor(turning.omega, turning.alpha, toLegBasis(leg, -gravity));
  const BodyRegressor rod = bodyRegressor(toRodFrame(turning.omega), toRodFrame(turning.alpha),
                                          toRodFrame(toLegBasis(leg, leg.tip_acceleration - gravity)));
  if (has_q1) {
    projectBody(cylinder, axis1, still, block.row(0).head<10>());
    projectBody(rod, toRodFrame(axis1), mechanism::Vector3(0.0, -length * leg.cos_q2, 0.0), block.row(0).tail<10>());
  } else {
    block.row(0).setZero();
  }
  projectBody(cylinder, axis2, still, block.row(1).head<10>());
  projectBody(rod, toRodFrame(axis2), mechanism::Vector3(-length, 0.0, 0.0), block.row(1).tail<10>());
  block.row(2).head<16>().setZero();
  block.row(2).segment<3>(16) = rod.force_per_first_moment.row(2);
  block(2, 19) = rod.force_per_mass.z();
}

/// K_PM: rows Xm, Zm, theta, psi.
void platformBlock(const mechanism::PlatformMotion& platform, const mechanism::Vector3& gravity,
                   RegressorData::PlatformBlock& block) {
  const mechanism::Matrix3 to_body = platform.rotation.transpose();
  const BodyRegressor body =
      bodyRegressor(to_body * platform.omega, to_body * platform.alpha, to_body * (platform.acceleration - gravity));
  const mechanism::Vector3 still = mechanism::Vector3::Zero();
  projectBody(body, still, to_body.col(0), block.row(0));
  projectBody(body, still, to_body.col(2), block.row(1));
  projectBody(body, to_body.col(1), still, block.row(2));
  projectBody(body, mechanism::Vector3::UnitZ(), still, block.row(3));
}

double coulombSign(double velocity, double width) {
  if (width > 0.0) return std::tanh(velocity / width);
  return velocity > 0.0 ? 1.0 : (velocity < 0.0 ? -1.0 : 0.0);
}

void fillBlocks(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                const mechanism::Motion& motion, RegressorData& data) {
  mechanism::robotMotion(mechanism, motion, data.motion);
  for (int i = 0; i < mechanism::kLegs; ++i)
    legBlock(data.motion.legs[i], gravity, i != 3, data.leg[i]);
  platformBlock(data.motion.platform, gravity, data.platform);
}

bool invertJacobian(RegressorData& data) {
  bool invertible = false;
  double determinant = 0.0;
  data.motion.jacobian.computeInverseAndDetWithCheck(data.pose_per_length, determinant, invertible, 1e-14);
  return invertible && data.pose_per_length.allFinite();
}

/// Friction columns of leg i: joint force along each joint's own coordinate, brought to the actuators.
void frictionColumns(int i, RegressorData& data, const CoulombWidth& width, int& column) {
  const mechanism::LegMotion& leg = data.motion.legs[i];
  for (int joint = 2; joint >= (i == 3 ? 1 : 0); --joint) {
    const double rate = leg.rate[joint];
    const double sign = coulombSign(rate, joint == 2 ? width.linear_m_per_s : width.angular_rad_per_s);
    const auto lever = data.joints_per_length[i].row(joint).transpose();
    data.k.col(column++) = lever * rate;
    data.k.col(column++) = lever * sign;
  }
}

}  // namespace

bool projectedRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                        const mechanism::Motion& motion, RegressorData& data, const CoulombWidth& width) {
  fillBlocks(mechanism, gravity, motion, data);
  if (!invertJacobian(data)) return false;
  int column = kInertialParameters;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    mechanism::Matrix34& joints = data.joints_per_length[i];
    joints.noalias() = data.motion.legs[i].joints_per_pose * data.pose_per_length;
    joints.row(2) = mechanism::Vector4::Unit(i).transpose();  // its own length, free of the inverse's rounding
    data.k.middleCols<2 * kLinkParameters>(2 * kLinkParameters * i).noalias() = joints.transpose() * data.leg[i];
    frictionColumns(i, data, width, column);
  }
  data.k.middleCols<kLinkParameters>(kPlatformLink * kLinkParameters).noalias() =
      data.pose_per_length.transpose() * data.platform;
  return true;
}

mechanism::Vector4 actuatorRegressor(double velocity, double acceleration, double coulomb_width_m_per_s) {
  return {velocity, coulombSign(velocity, coulomb_width_m_per_s), acceleration, 1.0};
}

bool extendedRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                       const mechanism::Motion& motion, RegressorData& data, ExtendedRegressor& result,
                       const CoulombWidth& width) {
  if (!projectedRegressor(mechanism, gravity, motion, data, width)) return false;
  result.leftCols<kInertialParameters>() = data.k.leftCols<kInertialParameters>();
  result.rightCols<extended::kParameters - extended::kViscous>().setZero();
  int from = kInertialParameters, passive = extended::kPassiveFriction;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::LegMotion& leg = data.motion.legs[i];
    const mechanism::Vector4 own = actuatorRegressor(leg.rate[2], leg.acceleration[2], width.linear_m_per_s);
    result(i, extended::kViscous + i) = own[0];
    result(i, extended::kCoulomb + i) = own[1];
    result(i, extended::kRotor + i) = own[2];
    result(i, extended::kOffset + i) = own[3];
    from += 2;
    for (int k = 0; k < (i == 3 ? 2 : 4); ++k)
      result.col(passive++) = data.k.col(from++);
  }
  return true;
}

void treeRegressor(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                   const mechanism::Motion& motion, RegressorData& data, TreeRegressor& result) {
  fillBlocks(mechanism, gravity, motion, data);
  result.setZero();
  for (int i = 0; i < mechanism::kLegs; ++i) {
    for (int joint = 2, row = 3 * i; joint >= (i == 3 ? 1 : 0); --joint, ++row) {
      result.row(row).segment<2 * kLinkParameters>(2 * kLinkParameters * i) = data.leg[i].row(joint);
    }
  }
  for (int k = 0; k < 4; ++k)
    result.row(11 + k).tail<kLinkParameters>() = data.platform.row(3 - k);
}

void treeFrictionRegressor(const mechanism::Mechanism& mechanism, const mechanism::Motion& motion, RegressorData& data,
                           TreeFrictionRegressor& result, const CoulombWidth& width) {
  mechanism::robotMotion(mechanism, motion, data.motion);
  result.setZero();
  int column = 0;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    for (int joint = 2, row = 3 * i; joint >= (i == 3 ? 1 : 0); --joint, ++row) {
      const double rate = data.motion.legs[i].rate[joint];
      result(row, column++) = rate;
      result(row, column++) = coulombSign(rate, joint == 2 ? width.linear_m_per_s : width.angular_rad_per_s);
    }
  }
}

}  // namespace knee_robot::dynamics
