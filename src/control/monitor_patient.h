#pragma once

#include <array>

#include "knee_robot/control/patient_limits.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {

/// The platform's pose and speed against a patient's limits, by forward kinematics of the measured lengths, once a
/// cycle. The speed is the way over the last kWindow_s: encoder steps and the slips of a dry screw at its reversals are
/// shorter, a joint feels neither; what is faster for longer is. What goes to and fro (a spasm, a loop that oscillates)
/// gets nowhere: the way to and fro over the last kShake_s must not be kShakes times what the patient's speeds allow.
/// (Healthy machines with 20 N more friction at rest and 15 kg stay below 1.2 times.) A pose that cannot be calculated is
/// broken.
class PatientMonitor {
 public:
  static constexpr double kWindow_s = 0.25;
  static constexpr double kShake_s = 1.0, kShakes = 2.0;
  enum class Verdict { Fine, Pose, Speed };

  explicit PatientMonitor(const mechanism::Robot& robot) : mechanism_(robot.mechanism) {}

  /// `lengths` m; `dt` s since the last call; `speed_factor` of the patient's speeds is allowed.
  Verdict step(const PatientRange& range, const std::array<double, 4>& lengths, double dt, double margin_m,
               double margin_rad, double speed_factor) noexcept;
  void reset() noexcept {
    pose_known_ = false;
    forgetSpeed();
  }
  /// What was moved until now does not count.
  void forgetSpeed() noexcept;

 private:
  struct Passed {
    double time = 0.0;
    mechanism::Pose pose = mechanism::Pose::Zero();
  };
  static constexpr std::size_t kSteps = 16;  // the window moves on by a step at a time
  /// Of kShake_s: a tremor of 20 Hz is seen, an encoder that dithers by a count is not.
  static constexpr std::size_t kWays = 100;

  void keep() noexcept;
  void walk() noexcept;

  std::optional<mechanism::Mechanism> mechanism_;
  double time_ = 0.0;
  mechanism::Pose pose_ = mechanism::Pose::Zero();
  bool pose_known_ = false;                              // a guess for the next
  std::array<Passed, kSteps> passed_;                    // a ring; the oldest is where the next will be put
  std::size_t kept_ = 0;                                 // ever since reset
  std::array<mechanism::Vector4, kWays> ways_;           // a ring, like that: (of X and Z together, 0, theta, psi)
  mechanism::Vector4 way_ = mechanism::Vector4::Zero();  // of all of them
  Passed stepped_;                                       // where the last of them ended
  std::size_t walked_ = 0;                               // ever since reset
};

}  // namespace knee_robot::control
