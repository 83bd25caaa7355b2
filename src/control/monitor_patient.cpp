#include "monitor_patient.h"

#include <algorithm>

namespace knee_robot::control {

PatientMonitor::Verdict PatientMonitor::step(const PatientRange& range, const std::array<double, 4>& lengths, double dt,
                                             double margin_m, double margin_rad, double speed_factor) noexcept {
  if (!range.given || !mechanism_) return Verdict::Fine;
  const mechanism::Lengths now(lengths[0], lengths[1], lengths[2], lengths[3]);
  const mechanism::ForwardResult found = kept_ > 0 ? mechanism::forwardKinematics(*mechanism_, now, pose_)
                                                   : mechanism::forwardKinematicsFromHome(*mechanism_, now);
  if (!found.ok()) return Verdict::Pose;
  time_ += dt;
  pose_ = found.pose;
  if (!range.contains(pose_, margin_m, margin_rad)) return Verdict::Pose;
  keep();
  // Until the window is full, divide by the full window, so that a start is not taken for speed.
  const Passed& oldest = passed_[kept_ < kSteps ? 0 : kept_ % kSteps];
  const mechanism::Vector4 speed = (pose_ - oldest.pose) / std::max(kWindow_s, time_ - oldest.time);
  return range.allowsSpeed(speed, speed_factor) ? Verdict::Fine : Verdict::Speed;
}

void PatientMonitor::keep() noexcept {
  const Passed& newest = passed_[(kept_ + kSteps - 1) % kSteps];
  if (kept_ > 0 && time_ - newest.time < kWindow_s / (kSteps - 1)) return;
  passed_[kept_ % kSteps] = {time_, pose_};
  ++kept_;
}

}  // namespace knee_robot::control
