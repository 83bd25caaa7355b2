#pragma once

#include <array>
#include <limits>
#include <string>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::control {

/// Where and how fast one patient's leg may be moved. Plain data, so that it can be handed to the real-time side.
struct PatientRange {
  bool given = false;               ///< false: nobody is on the robot; only its own limits hold
  std::array<double, 4> minimum{};  ///< Xm, Zm (m), theta, psi (rad)
  std::array<double, 4> maximum{};
  double linear_m_per_s = 0.020;           ///< of the platform's origin: 20 mm/s is the paper's
  double angular_rad_per_s = 0.034906585;  ///< of theta and of psi: 2 deg/s is the paper's
  /// What the platform may press or be pressed with, beyond what the model expects and the declared payload.
  double force_N = std::numeric_limits<double>::infinity();
  double moment_Nm = std::numeric_limits<double>::infinity();  ///< about theta's and psi's axes, each

  bool contains(const mechanism::Pose& pose, double margin_m, double margin_rad) const noexcept;
  bool limitsForce() const noexcept { return force_N < 1e300 || moment_Nm < 1e300; }
  /// Of a wrench on Xm, Zm (N), theta, psi (N m).
  bool allowsForce(const std::array<double, 4>& wrench) const noexcept;
  bool allowsSpeed(const mechanism::Vector4& pose_velocity, double factor) const noexcept;
};

/// Content of a patient file (YAML, strict):
///
///     patient: "initials or a number"      # for messages and recordings; no more than is needed
///     pose:                                # what the patient's joint may be taken to; inside the robot's reach
///       {X_m: [-0.05, 0.05], Z_m: [0.62, 0.72], theta_deg: [-5, 20], psi_deg: [-10, 10]}
///     speed: {linear_mm_per_s: 20, angular_deg_per_s: 2}   # optional, as are its keys: these are the defaults
///     force: {force_N: 60, moment_Nm: 15}                  # optional, as are its keys; needs an identified model
struct PatientLimits {
  std::string path;
  std::string mark;  ///< of the content that these limits were read from (fingerprint)
  std::string name;
  PatientRange range;
};

/// InputError (file, line, limit) for anything unknown or senseless: an empty interval, lengths that no leg reaches, a
/// speed above the robot's own. Throws InputError for a robot without platform (mechanism axes), too.
PatientLimits loadPatientLimits(const std::string& path, const mechanism::Robot& robot);

/// Checks a reference that the robot's own check has let through: every pose inside the range, every interval within
/// the speeds.
/// Throws InputError naming the reference's line, what was broken and by how much.
void requireWithinPatient(const trajectory::ReferenceCheck& check, const trajectory::Reference& reference,
                          const PatientLimits& patient);

}  // namespace knee_robot::control
