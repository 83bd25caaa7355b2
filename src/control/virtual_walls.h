#pragma once

#include "knee_robot/control/patient_limits.h"

namespace knee_robot::control {

/// Where the platform may be guided by hand, as walls that push back: legs' lengths and joint angles, the singularity
/// margin (trajectory::planningCondition: where the robot file leaves it wide open, kPlanningCondition), and the
/// patient's pose. Each wall begins a zone before its limit; in it the push rises in proportion to the depth, up to
/// largest_N at the limit (on the platform; moments: times kLever_m). Real-time safe.
class VirtualWalls {
 public:
  static constexpr double kLength_m = 0.01;   ///< zone before a leg's shortest and longest length
  static constexpr double kPose_m = 0.008;    ///< zone before the patient's range
  static constexpr double kPose_rad = 0.04;   ///< likewise, angles
  static constexpr double kAngle_rad = 0.06;  ///< zone before a joint's angle
  static constexpr double kCondition = 0.2;   ///< zone before the singularity margin, share of it
  static constexpr double kLever_m = 0.2;

  /// By which the walls push back.
  struct Push {
    mechanism::Vector4 wrench = mechanism::Vector4::Zero();  ///< on Xm, Zm (N), theta, psi (N m)
    mechanism::Vector4 force = mechanism::Vector4::Zero();   ///< on the legs, N
    double depth = 0.0;  ///< of the deepest wall: 0 outside its zone, 1 at the limit
  };

  explicit VirtualWalls(const mechanism::Robot& robot);
  Push at(const mechanism::Pose& pose, const mechanism::Lengths& lengths, const PatientRange& patient,
          double largest_N) const noexcept;

 private:
  /// Of joint angles and singularity: the smallest share of a zone that is left; 1 and more outside.
  double freedom(const mechanism::Pose& pose) const noexcept;
  void addPose(const mechanism::Pose& pose, const PatientRange& patient, double largest_N, Push& push) const noexcept;
  void addJoints(const mechanism::Pose& pose, double largest_N, Push& push) const noexcept;

  std::optional<mechanism::Mechanism> mechanism_;
  mechanism::JointLimits joints_;
  double condition_max_;
  mechanism::Vector4 shortest_ = mechanism::Vector4::Zero(), longest_ = mechanism::Vector4::Zero();
};

}  // namespace knee_robot::control
