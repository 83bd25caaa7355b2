#pragma once

#include <array>

#include "knee_robot/control/patient_limits.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {

/// The platform's pose and speed against a patient's limits, by forward kinematics of the measured lengths, once a
/// cycle. The speed is the way over the last kWindow_s: encoder steps and the slips of a dry screw at its reversals are
/// shorter, a joint feels neither; what is faster for longer is. A pose that cannot be calculated is broken.
class PatientMonitor {
 public:
  static constexpr double kWindow_s = 0.25;
  enum class Verdict { Fine, Pose, Speed };

  explicit PatientMonitor(const mechanism::Robot& robot) : mechanism_(robot.mechanism) {}

  /// `lengths` m; `dt` s since the last call; `speed_factor` of the patient's speeds is allowed.
  Verdict step(const PatientRange& range, const std::array<double, 4>& lengths, double dt, double margin_m,
               double margin_rad, double speed_factor) noexcept;
  void reset() noexcept { kept_ = 0; }

 private:
  struct Passed {
    double time = 0.0;
    mechanism::Pose pose = mechanism::Pose::Zero();
  };
  static constexpr std::size_t kSteps = 16;  // the window moves on by a step at a time

  void keep() noexcept;

  std::optional<mechanism::Mechanism> mechanism_;
  double time_ = 0.0;
  mechanism::Pose pose_ = mechanism::Pose::Zero();
  std::array<Passed, kSteps> passed_;  // a ring; the oldest is where the next will be put
  std::size_t kept_ = 0;               // ever since reset
};

}  // namespace knee_robot::control
