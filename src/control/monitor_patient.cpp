#include "monitor_patient.h"

#include <algorithm>

namespace knee_robot::control {

PatientMonitor::Verdict PatientMonitor::step(const PatientRange& range, const std::array<double, 4>& lengths, double dt,
                                             double margin_m, double margin_rad, double speed_factor) noexcept {
  if (!range.given || !mechanism_) return Verdict::Fine;
  const mechanism::Lengths now(lengths[0], lengths[1], lengths[2], lengths[3]);
  const mechanism::ForwardResult found = pose_known_ ? mechanism::forwardKinematics(*mechanism_, now, pose_)
                                                     : mechanism::forwardKinematicsFromHome(*mechanism_, now);
  pose_known_ = found.ok();
  if (!pose_known_) return Verdict::Pose;
  time_ += dt;
  pose_ = found.pose;
  if (!range.contains(pose_, margin_m, margin_rad)) return Verdict::Pose;
  keep();
  walk();
  // Until the window is full, divide by the full window, so that a start is not taken for speed.
  const Passed& oldest = passed_[kept_ < kSteps ? 0 : kept_ % kSteps];
  const mechanism::Vector4 speed = (pose_ - oldest.pose) / std::max(kWindow_s, time_ - oldest.time);
  const bool allowed = range.allowsSpeed(speed, speed_factor) && range.allowsSpeed(way_ / kShake_s, kShakes);
  return allowed ? Verdict::Fine : Verdict::Speed;
}

void PatientMonitor::forgetSpeed() noexcept {
  kept_ = walked_ = 0;
  way_.setZero();
}

void PatientMonitor::walk() noexcept {
  const bool begins = walked_ == 0;
  if (!begins && time_ - stepped_.time < kShake_s / kWays) return;
  mechanism::Vector4 way = begins ? mechanism::Vector4::Zero() : mechanism::Vector4((pose_ - stepped_.pose).cwiseAbs());
  way[0] = way.head<2>().norm();
  way[1] = 0.0;
  mechanism::Vector4& oldest = ways_[walked_ % kWays];
  way_ += walked_ < kWays ? way : mechanism::Vector4(way - oldest);
  oldest = way;
  stepped_ = {time_, pose_};
  ++walked_;
}

void PatientMonitor::keep() noexcept {
  const Passed& newest = passed_[(kept_ + kSteps - 1) % kSteps];
  if (kept_ > 0 && time_ - newest.time < kWindow_s / (kSteps - 1)) return;
  passed_[kept_ % kSteps] = {time_, pose_};
  ++kept_;
}

}  // namespace knee_robot::control
