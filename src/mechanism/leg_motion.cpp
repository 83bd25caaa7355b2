#include "knee_robot/mechanism/leg_motion.h"

#include <Eigen/Geometry>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::mechanism {
namespace {

/// d(arm)/d(theta) and d(arm)/d(psi) as columns 2 and 3; origin's translation as columns 0 and 1.
void tipPartials(const Vector3& arm, const Vector3& normal, Matrix34& out) {
  out.col(0) = Vector3::UnitX();
  out.col(1) = Vector3::UnitZ();
  out.col(2) = Vector3(arm.z(), 0.0, -arm.x());
  out.col(3) = normal.cross(arm);
}

/// Leg basis of legs 1 to 3 from u = (cos q1 cos q2, sin q2, sin q1 cos q2).
void universalBasis(LegMotion& leg) {
  leg.cos_q2 = std::sqrt(leg.u.x() * leg.u.x() + leg.u.z() * leg.u.z());
  leg.sin_q2 = leg.u.y();
  const double c1 = leg.u.x() / leg.cos_q2, s1 = leg.u.z() / leg.cos_q2;
  leg.n = Vector3(-s1, 0.0, c1);
  leg.t = Vector3(-c1 * leg.sin_q2, leg.cos_q2, -s1 * leg.sin_q2);
}

/// Rates and accelerations of (q1, q2, q3) from the tip's, by differentiating tip = base + q3 u(q1, q2) twice.
void universalRates(const Vector3& velocity, LegMotion& leg) {
  const double length = leg.length, s2 = leg.sin_q2, c2 = leg.cos_q2;
  const double per_turn = 1.0 / length, per_swing = 1.0 / (length * c2);
  const Vector3 rate(leg.n.dot(velocity) * per_swing, leg.t.dot(velocity) * per_turn, leg.u.dot(velocity));
  const double swing = c2 * rate[0];
  const Vector3& a = leg.tip_acceleration;
  leg.rate = rate;
  leg.acceleration[0] = (leg.n.dot(a) - 2.0 * rate[2] * swing) * per_swing + 2.0 * s2 / c2 * rate[0] * rate[1];
  leg.acceleration[1] = (leg.t.dot(a) - 2.0 * rate[2] * rate[1]) * per_turn - s2 * swing * rate[0];
  leg.acceleration[2] = leg.u.dot(a) + length * (rate[1] * rate[1] + swing * swing);
  leg.joints_per_pose.row(0).noalias() = (leg.n * per_swing).transpose() * leg.tip_per_pose;
  leg.joints_per_pose.row(1).noalias() = (leg.t * per_turn).transpose() * leg.tip_per_pose;
  leg.joints_per_pose.row(2).noalias() = leg.u.transpose() * leg.tip_per_pose;
}

/// Leg 4 in the XZ plane: only q41 (its q2) and q42 (its q3), and only Xm and Zm move it.
void planarRates(const Vector3& velocity, LegMotion& leg) {
  const double per_turn = 1.0 / leg.length;
  const Vector3& a = leg.tip_acceleration;
  leg.rate = Vector3(0.0, leg.t.dot(velocity) * per_turn, leg.u.dot(velocity));
  leg.acceleration = Vector3(0.0, (leg.t.dot(a) - 2.0 * leg.rate[2] * leg.rate[1]) * per_turn,
                             leg.u.dot(a) + leg.length * leg.rate[1] * leg.rate[1]);
  leg.joints_per_pose.setZero();
  leg.joints_per_pose(1, 0) = leg.t.x() * per_turn;
  leg.joints_per_pose(1, 1) = leg.t.z() * per_turn;
  leg.joints_per_pose(2, 0) = leg.u.x();
  leg.joints_per_pose(2, 1) = leg.u.z();
}

void universalLeg(const Vector3& base, const Vector3& origin, const Vector3& origin_velocity, const Vector3& arm,
                  const PlatformMotion& platform, LegMotion& leg) {
  const Vector3 turning = platform.omega.cross(arm);
  const Vector3 span = origin + arm - base;
  leg.length = span.norm();
  leg.u = span / leg.length;
  leg.tip_acceleration = platform.acceleration + platform.alpha.cross(arm) + platform.omega.cross(turning);
  tipPartials(arm, platform.rotation.col(2), leg.tip_per_pose);
  universalBasis(leg);
  universalRates(origin_velocity + turning, leg);
}

void planarLeg(const Vector3& base, const Vector3& origin, const Vector3& origin_velocity,
               const PlatformMotion& platform, LegMotion& leg) {
  const Vector3 span = origin - base;
  leg.length = std::sqrt(span.x() * span.x() + span.z() * span.z());
  leg.u = span / leg.length;
  leg.n = -Vector3::UnitY();
  leg.t = Vector3(-leg.u.z(), 0.0, leg.u.x());
  leg.sin_q2 = 0.0;
  leg.cos_q2 = 1.0;
  leg.tip_acceleration = platform.acceleration;
  tipPartials(Vector3::Zero(), platform.rotation.col(2), leg.tip_per_pose);
  planarRates(origin_velocity, leg);
}

}  // namespace

void robotMotion(const Mechanism& mechanism, const Motion& motion, RobotMotion& out) {
  PlatformMotion& platform = out.platform;
  platform.rotation = platformRotation(motion.pose);
  const Vector3 normal = platform.rotation.col(2);
  const double theta_rate = motion.pose_velocity[2], psi_rate = motion.pose_velocity[3];
  // The psi axis turns with theta: its rate theta' Y x normal adds to the angular acceleration.
  const Vector3 normal_rate = theta_rate * Vector3(normal.z(), 0.0, -normal.x());
  platform.omega = psi_rate * normal;
  platform.omega.y() += theta_rate;
  platform.alpha = motion.pose_acceleration[3] * normal + psi_rate * normal_rate;
  platform.alpha.y() += motion.pose_acceleration[2];
  platform.acceleration = Vector3(motion.pose_acceleration[0], 0.0, motion.pose_acceleration[1]);

  const Vector3 origin(motion.pose[0], 0.0, motion.pose[1]);
  const Vector3 velocity(motion.pose_velocity[0], 0.0, motion.pose_velocity[1]);
  for (int i = 0; i < 3; ++i) {
    const Vector3 arm = platform.rotation * mechanism.platform_points[i];
    universalLeg(mechanism.base_points[i], origin, velocity, arm, platform, out.legs[i]);
  }
  planarLeg(mechanism.base_points[3], origin, velocity, platform, out.legs[3]);
  for (int i = 0; i < kLegs; ++i)
    out.jacobian.row(i) = out.legs[i].joints_per_pose.row(2);
}

ForwardStatus motionFromLengths(const Mechanism& mechanism, const Lengths& lengths, const Vector4& length_velocity,
                                const Vector4& length_acceleration, const Pose& guess, Motion& motion) {
  const ForwardResult result = forwardKinematics(mechanism, lengths, guess);
  if (!result.ok()) return result.status;
  Vector4 velocity, acceleration;
  if (!poseRates(mechanism, result.pose, length_velocity, length_acceleration, velocity, acceleration)) {
    return ForwardStatus::NearSingular;
  }
  motion = {result.pose, velocity, acceleration};
  return ForwardStatus::Converged;
}

const std::array<const char*, kUrdfJoints>& urdfJointNames() {
  static const std::array<const char*, kUrdfJoints> names = {"q11", "q12", "q13", "q21", "q22",     "q23",  "q31",
                                                             "q32", "q33", "q41", "q42", "theta_4", "psi_4"};
  return names;
}

std::array<double, kUrdfJoints> urdfJointPositions(const Mechanism& mechanism, const Pose& pose) {
  const JointCoordinates q = inverseKinematics(mechanism, pose);
  std::array<double, kUrdfJoints> values{};
  for (int i = 0; i < 3; ++i) {
    values[3 * i] = q.q1[i];
    values[3 * i + 1] = q.q2[i];
    values[3 * i + 2] = q.q3[i];
  }
  values[9] = q.q41;
  values[10] = q.q42;
  values[11] = pose[2] + q.q41 - kPi / 2;
  values[12] = pose[3];
  return values;
}

}  // namespace knee_robot::mechanism
