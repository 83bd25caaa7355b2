#include "instant_slopes.h"

#include <ceres/jet.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace knee_robot::excitation {
namespace {

constexpr int kInputs = 12;  ///< pose, pose velocity, pose acceleration
using Dual = ceres::Jet<double, kInputs>;
using Dual3 = Eigen::Matrix<Dual, 3, 1>;
using Dual34 = Eigen::Matrix<Dual, 3, 4>;
using Gradient = Eigen::Matrix<double, kInputs, 1>;
using Weights = Eigen::Matrix<double, 4, dynamics::kPaperParameters>;  ///< per pose coordinate

Dual dot(const Dual3& a, const Dual3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Dual3 cross(const Dual3& a, const Dual3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Dual3 constant(const mechanism::Vector3& v) {
  return v.cast<Dual>();
}

struct DualPlatform {
  Eigen::Matrix<Dual, 3, 3> rotation;
  Dual3 normal, omega, alpha, origin, velocity, acceleration;
};

/// Eq. (5), and its derivatives as in robotMotion.
DualPlatform platformOf(const mechanism::Motion& motion) {
  Dual pose[4], rate[4], acceleration[4];
  for (int c = 0; c < 4; ++c) {
    pose[c] = Dual(motion.pose[c], c);
    rate[c] = Dual(motion.pose_velocity[c], 4 + c);
    acceleration[c] = Dual(motion.pose_acceleration[c], 8 + c);
  }
  const Dual zero(0.0), ct = cos(pose[2]), st = sin(pose[2]), cp = cos(pose[3]), sp = sin(pose[3]);
  DualPlatform p;
  p.rotation << cp * ct, -sp * ct, st, sp, cp, zero, -cp * st, sp * st, ct;
  p.normal = Dual3(st, zero, ct);
  const Dual3 normal_rate(rate[2] * ct, zero, -rate[2] * st);
  p.omega = Dual3(rate[3] * st, rate[2], rate[3] * ct);
  p.alpha = acceleration[3] * p.normal + rate[3] * normal_rate;
  p.alpha[1] += acceleration[2];
  p.origin = Dual3(pose[0], zero, pose[1]);
  p.velocity = Dual3(rate[0], zero, rate[1]);
  p.acceleration = Dual3(acceleration[0], zero, acceleration[1]);
  return p;
}

struct DualLeg {
  Dual3 u, n, t, rate, acceleration, tip_acceleration;  ///< as in LegMotion
  Dual length, sin_q2, cos_q2;
  Dual34 joints_per_pose;
};

DualLeg legOf(const mechanism::Mechanism& mechanism, const DualPlatform& p, int i) {
  const Dual zero(0.0), one(1.0);
  DualLeg leg;
  const Dual3 arm = p.rotation * constant(mechanism.platform_points[i]);
  const Dual3 span = p.origin + arm - constant(mechanism.base_points[i]);
  const Dual3 turning = cross(p.omega, arm), tip_velocity = p.velocity + turning;
  leg.tip_acceleration = p.acceleration + cross(p.alpha, arm) + cross(p.omega, turning);
  leg.length = sqrt(dot(span, span));
  leg.u = span / leg.length;
  const bool planar = i == 3;  // its base joint turns about -Y, and its tip is the platform's origin
  leg.sin_q2 = planar ? zero : leg.u[1];
  leg.cos_q2 = planar ? one : sqrt(leg.u[0] * leg.u[0] + leg.u[2] * leg.u[2]);
  leg.n = planar ? Dual3(zero, -one, zero) : Dual3(-leg.u[2] / leg.cos_q2, zero, leg.u[0] / leg.cos_q2);
  leg.t = cross(leg.n, leg.u);
  const Dual per_turn = one / leg.length, per_swing = planar ? zero : per_turn / leg.cos_q2;
  const Dual3& a = leg.tip_acceleration;
  leg.rate = Dual3(dot(leg.n, tip_velocity) * per_swing, dot(leg.t, tip_velocity) * per_turn, dot(leg.u, tip_velocity));
  const Dual swing = leg.cos_q2 * leg.rate[0];
  leg.acceleration[0] = (dot(leg.n, a) - 2.0 * leg.rate[2] * swing) * per_swing +
                        2.0 * leg.sin_q2 / leg.cos_q2 * leg.rate[0] * leg.rate[1];
  leg.acceleration[1] = (dot(leg.t, a) - 2.0 * leg.rate[2] * leg.rate[1]) * per_turn - leg.sin_q2 * swing * leg.rate[0];
  leg.acceleration[2] = dot(leg.u, a) + leg.length * (leg.rate[1] * leg.rate[1] + swing * swing);
  const Dual3 tip_per_pose[4] = {Dual3(one, zero, zero), Dual3(zero, zero, one), Dual3(arm[2], zero, -arm[0]),
                                 cross(p.normal, arm)};
  for (int c = 0; c < 4; ++c) {
    leg.joints_per_pose(0, c) = dot(leg.n, tip_per_pose[c]) * per_swing;
    leg.joints_per_pose(1, c) = dot(leg.t, tip_per_pose[c]) * per_turn;
    leg.joints_per_pose(2, c) = dot(leg.u, tip_per_pose[c]);
  }
  return leg;
}

struct Wrench {
  Dual3 force, moment;
};

/// Newton and Euler about the frame's origin for ten link parameters (numbers or dual numbers).
template <typename Parameter>
Wrench newtonEuler(const Eigen::Matrix<Parameter, 10, 1>& p, const Dual3& w, const Dual3& e, const Dual3& a) {
  const auto inertiaTimes = [&p](const Dual3& v) {
    return Dual3(v[0] * p[0] + v[1] * p[1] + v[2] * p[2], v[0] * p[1] + v[1] * p[3] + v[2] * p[4],
                 v[0] * p[2] + v[1] * p[4] + v[2] * p[5]);
  };
  const auto crossFirst = [&p](const Dual3& v) {  // v x (mx, my, mz)
    return Dual3(v[1] * p[8] - v[2] * p[7], v[2] * p[6] - v[0] * p[8], v[0] * p[7] - v[1] * p[6]);
  };
  return {Dual3(a * Dual(p[9])) + crossFirst(e) + cross(w, crossFirst(w)),
          inertiaTimes(e) + cross(w, inertiaTimes(w)) - crossFirst(a)};
}

/// Linear functionals of K_x, the regressor on the pose coordinates: what `weights` make of it, and the load's forces.
struct Sums {
  Dual observation{0.0};
  Eigen::Matrix<Dual, 4, 1> force = Eigen::Matrix<Dual, 4, 1>::Constant(Dual(0.0));
};

Dual coulombSign(const Dual& rate, double width) {
  return tanh(rate / width);
}

void addLeg(const DualLeg& leg, int i, const mechanism::Vector3& gravity, const dynamics::CoulombWidth& width,
            const Weights& weights, const ExpectedLoad& load, Sums& sums) {
  const Dual zero(0.0), one(1.0);
  const Dual c2 = leg.cos_q2, s2 = leg.sin_q2;
  const Dual3 &v = leg.rate, &acc = leg.acceleration;
  const auto toLeg = [&leg](const Dual3& x) { return Dual3(-dot(leg.t, x), dot(leg.u, x), dot(leg.n, x)); };
  const auto toRod = [](const Dual3& x) { return Dual3(x[0], -x[2], x[1]); };
  const Dual3 omega(c2 * v[0], -s2 * v[0], v[1]);
  const Dual3 alpha(c2 * acc[0] - s2 * v[0] * v[1], -s2 * acc[0] - c2 * v[0] * v[1], acc[1]);
  const Dual3 cylinder_a = toLeg(constant(-gravity)), rod_a = toRod(toLeg(leg.tip_acceleration - constant(gravity)));
  const Dual3 rod_omega = toRod(omega), rod_alpha = toRod(alpha);
  const Dual3 axis[2] = {Dual3(c2, -s2, zero), Dual3(zero, zero, one)};
  const Dual3 rod_axis[2] = {toRod(axis[0]), toRod(axis[1])};
  // Force on joint j of what the two bodies' wrenches are.
  const auto onJoint = [&](int j, const Wrench& cylinder, const Wrench& rod) -> Dual {
    if (j == 2) return rod.force[2];
    const Dual travel = j == 0 ? Dual(-leg.length * c2 * rod.force[1]) : Dual(-leg.length * rod.force[0]);
    return dot(axis[j], cylinder.moment) + dot(rod_axis[j], rod.moment) + travel;
  };
  const int first = 2 * dynamics::kLinkParameters * i, first_joint = i == 3 ? 1 : 0;
  const dynamics::LinkParameters cylinder_load = load.parameters.segment<10>(first),
                                 rod_load = load.parameters.segment<10>(first + 10);
  const Wrench loaded_cylinder = newtonEuler(cylinder_load, omega, alpha, cylinder_a),
               loaded_rod = newtonEuler(rod_load, rod_omega, rod_alpha, rod_a);
  int friction = dynamics::kInertialParameters + 6 * i;
  for (int j = 2; j >= first_joint; --j, friction += 2) {
    Eigen::Matrix<Dual, 10, 1> of_cylinder, of_rod;
    const auto weight = [&](int column) -> Dual {
      return leg.joints_per_pose(j, 0) * weights(0, column) + leg.joints_per_pose(j, 1) * weights(1, column) +
             leg.joints_per_pose(j, 2) * weights(2, column) + leg.joints_per_pose(j, 3) * weights(3, column);
    };
    for (int k = 0; k < dynamics::kLinkParameters; ++k) {
      of_cylinder[k] = weight(first + k);
      of_rod[k] = weight(first + dynamics::kLinkParameters + k);
    }
    const Dual sign = coulombSign(v[j], j == 2 ? width.linear_m_per_s : width.angular_rad_per_s);
    sums.observation += onJoint(j, newtonEuler(of_cylinder, omega, alpha, cylinder_a),
                                newtonEuler(of_rod, rod_omega, rod_alpha, rod_a)) +
                        weight(friction) * v[j] + weight(friction + 1) * sign;
    const Dual force = onJoint(j, loaded_cylinder, loaded_rod) + load.parameters[friction] * v[j] +
                       load.parameters[friction + 1] * sign;
    for (int c = 0; c < 4; ++c)
      sums.force[c] += leg.joints_per_pose(j, c) * force;
  }
}

void addPlatform(const DualPlatform& p, const mechanism::Vector3& gravity, const Weights& weights,
                 const ExpectedLoad& load, Sums& sums) {
  const Eigen::Matrix<Dual, 3, 3> to_body = p.rotation.transpose();
  const Dual3 omega = to_body * p.omega, alpha = to_body * p.alpha, a = to_body * (p.acceleration - constant(gravity));
  const auto onCoordinate = [&](int c, const Wrench& wrench) -> Dual {
    if (c == 3) return wrench.moment[2];
    return c == 2 ? dot(to_body.col(1), wrench.moment) : dot(to_body.col(2 * c), wrench.force);
  };
  const dynamics::LinkParameters own = load.parameters.segment<10>(dynamics::kLinkParameters * dynamics::kPlatformLink);
  const Wrench loaded = newtonEuler(own, omega, alpha, a);
  for (int c = 0; c < 4; ++c) {
    const dynamics::LinkParameters row =
        weights.row(c).segment<10>(dynamics::kLinkParameters * dynamics::kPlatformLink).transpose();
    sums.observation += onCoordinate(c, newtonEuler(row, omega, alpha, a));
    sums.force[c] += onCoordinate(c, loaded);
  }
}

using Legs = DualLeg[mechanism::kLegs];
using SlopesByPose = Eigen::Matrix<double, slope_row::kRows, kInputs>;

/// Derivative of the sum of `w` times elements of dq/dx.
Gradient weightedSlope(const Legs& legs, const mechanism::Matrix4& w) {
  Gradient sum = Gradient::Zero();
  for (int i = 0; i < mechanism::kLegs; ++i) {
    for (int c = 0; c < 4; ++c)
      sum += w(i, c) * legs[i].joints_per_pose(2, c).v;
  }
  return sum;
}

void addCondition(const Legs& legs, const mechanism::Matrix4& jacobian, InstantSlopes& result, SlopesByPose& by_pose) {
  const Eigen::JacobiSVD<mechanism::Matrix4> svd(jacobian, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const mechanism::Vector4 s = svd.singularValues();
  result.value[slope_row::kCondition] = std::log(s[0] / s[3]);
  by_pose.row(slope_row::kCondition) =
      weightedSlope(legs, svd.matrixU().col(0) * svd.matrixV().col(0).transpose() / s[0] -
                              svd.matrixU().col(3) * svd.matrixV().col(3).transpose() / s[3])
          .transpose();
}

/// Of the actuators, expected.
void addForces(const Legs& legs, const mechanism::Matrix4& inverse, const Sums& sums, const ExpectedLoad& load,
               InstantSlopes& result, SlopesByPose& by_pose) {
  mechanism::Vector4 on_coordinates;
  for (int c = 0; c < 4; ++c)
    on_coordinates[c] = sums.force[c].a;
  const mechanism::Vector4 links = inverse.transpose() * on_coordinates;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const Dual& acceleration = legs[i].acceleration[2];
    result.value[slope_row::kForce + i] = links[i] + load.rotor_mass[i] * acceleration.a;
    const mechanism::Vector4 share = inverse.col(i);  // row i of J^-T
    Gradient slope = load.rotor_mass[i] * acceleration.v - weightedSlope(legs, links * share.transpose());
    for (int c = 0; c < 4; ++c)
      slope += share[c] * sums.force[c].v;
    by_pose.row(slope_row::kForce + i) = slope.transpose();
  }
}

}  // namespace

InstantSlopes instantSlopes(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                            const mechanism::Motion& motion, const dynamics::CoulombWidth& width,
                            const PaperRegressor& regressor, const PaperRegressor& weights, const ExpectedLoad& load) {
  const DualPlatform platform = platformOf(motion);
  Legs legs;
  for (int i = 0; i < mechanism::kLegs; ++i)
    legs[i] = legOf(mechanism, platform, i);
  mechanism::Matrix4 jacobian;  // dq/dx
  for (int i = 0; i < mechanism::kLegs; ++i) {
    for (int c = 0; c < 4; ++c)
      jacobian(i, c) = legs[i].joints_per_pose(2, c).a;
  }
  const mechanism::Matrix4 inverse = jacobian.inverse();

  Sums sums;
  const Weights on_pose = inverse * weights;
  for (int i = 0; i < mechanism::kLegs; ++i)
    addLeg(legs[i], i, gravity, width, on_pose, load, sums);
  addPlatform(platform, gravity, on_pose, load, sums);

  InstantSlopes result;
  SlopesByPose by_pose;
  // K* = J^-T K_x, so <G, dK*> = <J^-1 G, dK_x> - <K* (J^-1 G)^T, dJ>.
  result.value[slope_row::kObservation] = sums.observation.a;
  by_pose.row(slope_row::kObservation) =
      (sums.observation.v - weightedSlope(legs, regressor * on_pose.transpose())).transpose();
  const auto set = [&](int row, const Dual& dual) {
    result.value[row] = dual.a;
    by_pose.row(row) = dual.v.transpose();
  };
  for (int i = 0; i < mechanism::kLegs; ++i) {
    set(slope_row::kBaseCosine + i, legs[i].u[2]);
    if (i < 3) set(slope_row::kTipCosine + i, dot(legs[i].u, platform.normal));
  }
  addCondition(legs, jacobian, result, by_pose);
  addForces(legs, inverse, sums, load, result, by_pose);

  Eigen::Matrix<double, kInputs, kInputs> actuators;  // lengths, velocities, accelerations by pose inputs
  for (int i = 0; i < mechanism::kLegs; ++i) {
    actuators.row(i) = legs[i].length.v.transpose();
    actuators.row(mechanism::kLegs + i) = legs[i].rate[2].v.transpose();
    actuators.row(2 * mechanism::kLegs + i) = legs[i].acceleration[2].v.transpose();
  }
  result.slope = actuators.transpose().partialPivLu().solve(by_pose.transpose()).transpose();
  return result;
}

}  // namespace knee_robot::excitation
