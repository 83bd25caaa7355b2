#include "knee_robot/control/monitor_patient.h"

namespace knee_robot {
namespace {
constexpr double kSpeedTime_s = 0.032;  // 5 Hz
}

PatientMonitor::Verdict PatientMonitor::step(const PatientRange& range, const std::array<double, 4>& lengths,
                                             const std::array<double, 4>& velocities, double dt, double margin_m,
                                             double margin_rad, double speed_factor) noexcept {
  if (!range.given || !mechanism_) return Verdict::Fine;
  const Lengths now(lengths[0], lengths[1], lengths[2], lengths[3]);
  const ForwardResult found =
      known_ ? forwardKinematics(*mechanism_, now, pose_) : forwardKinematicsFromHome(*mechanism_, now);
  if (!found.ok()) return Verdict::Pose;
  if (!known_) speed_.setZero();
  known_ = true;
  pose_ = found.pose;
  if (!range.contains(pose_, margin_m, margin_rad)) return Verdict::Pose;
  Vector4 speed, ignored;
  const Vector4 leg_speed(velocities[0], velocities[1], velocities[2], velocities[3]);
  if (!poseRates(*mechanism_, pose_, leg_speed, Vector4::Zero(), speed, ignored)) return Verdict::Pose;
  speed_ += (speed - speed_) * dt / (kSpeedTime_s + dt);
  return range.allowsSpeed(speed_, speed_factor) ? Verdict::Fine : Verdict::Speed;
}

}  // namespace knee_robot
