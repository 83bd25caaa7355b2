#pragma once

#include "knee_robot/control/patient_limits.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot {

/// The platform's pose and speed against a patient's limits, by forward kinematics of the measured lengths, once a cycle. The speed is
/// low-passed once more (5 Hz): platform speeds are differences of noisy leg velocities. A pose that cannot be calculated is broken.
class PatientMonitor {
 public:
  enum class Verdict { Fine, Pose, Speed };

  explicit PatientMonitor(const Robot& robot) : mechanism_(robot.mechanism) {}

  Verdict step(const PatientRange& range, const std::array<double, 4>& lengths, const std::array<double, 4>& velocities,
               double dt, double margin_m, double margin_rad, double speed_factor) noexcept;
  void reset() noexcept { known_ = false; }

 private:
  std::optional<Mechanism> mechanism_;
  bool known_ = false;
  Pose pose_ = Pose::Zero();
  Vector4 speed_ = Vector4::Zero();
};

}  // namespace knee_robot
