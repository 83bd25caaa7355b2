#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/mechanism/chain.h"
#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::mechanism {

/// What a recording holds of a drive's effort.
enum class Recorded { Force, Torque, Current };

/// One actuated axis: motor, screw, encoder, amplifier and their limits. SI units.
struct Actuator {
  double position_min_m = 0.0;  ///< shortest admissible leg length (bench axes: position)
  double position_max_m = 0.0;
  double velocity_max_m_per_s = 0.0;
  double acceleration_max_m_per_s2 = 0.0;
  double screw_lead_m = 0.010;            ///< metres per motor revolution
  double counts_per_revolution = 2000.0;  ///< any positive number: geared encoders need not be whole
  int encoder_sign = 1;                   ///< +1: counts grow when the leg lengthens
  double home_length_m = 0.0;             ///< leg length at the home position
  double force_per_volt_N = 56.8;         ///< actuator force per volt of command
  int force_sign = 1;                     ///< +1: positive volts lengthen the leg
  double voltage_max_V = 10.0;            ///< clamp of the command
  double force_continuous_N = 0.0;        ///< thermal limit; 0: none beyond the voltage
  double force_max_N = 0.0;               ///< peak limit; 0: none beyond the voltage

  // Joints of a chain only; see kJointRadius_m.
  std::string name;                     ///< of the joint; empty: leg or axis
  bool revolute = false;                ///< recorded in rad
  Recorded recorded = Recorded::Force;  ///< what the recorder wrote as the drive's effort
  double torque_per_ampere = 0.0;       ///< N m/A (prismatic: N/A) at the joint; 0: not known
  double torque_per_ampere_std = 0.0;   ///< 0: given, not estimated
  bool resolution_given = true;         ///< false: the robot file says nothing of the encoder
  double jointRadius() const { return revolute ? kJointRadius_m : 1.0; }
  double position_per_m() const { return 1.0 / jointRadius(); }  ///< recorded unit per m
  /// Recorded unit per N: N m, N or A.
  double force_per_N() const {
    return recorded == Recorded::Current ? jointRadius() / (torque_per_ampere > 0.0 ? torque_per_ampere : 1.0)
                                         : jointRadius();
  }

  double metresPerCount() const { return screw_lead_m / counts_per_revolution; }
  /// Largest force, N: the peak limit, or what the voltage allows.
  double forceLimit() const noexcept {
    const double by_voltage = voltage_max_V * force_per_volt_N;
    return force_max_N > 0.0 ? std::min(force_max_N, by_voltage) : by_voltage;
  }
};

/// Units as files write them: "m" or "rad"; "N", "Nm" or "A".
const char* positionUnit(const Actuator& actuator);
const char* forceUnit(const Actuator& actuator);

/// Largest angle between a leg's axis and the joint's neutral axis (platform normal for the spherical joint, base Z for
/// universal and revolute joint), rad.
struct JointLimits {
  double spherical_max = 0.0;
  double universal_max = 0.0;
  double revolute_max = 0.0;
};

enum class MechanismKind {
  ThreeUpsOneRpu,  ///< the parallel robot
  Axes,            ///< one to four independent actuators on a bench
  Chain,           ///< open chain from a URDF, 1 to 12 joints
};

/// Content of a robot file (docs/contract.md, section 2). Constant after loading.
struct Robot {
  std::string path;         ///< as given to loadRobot
  std::string fingerprint;  ///< of the file's bytes; a model remembers it
  MechanismKind kind = MechanismKind::ThreeUpsOneRpu;
  std::optional<Mechanism> mechanism;      ///< engaged for ThreeUpsOneRpu
  std::optional<Chain> chain;              ///< engaged for Chain
  Vector3 gravity{0.0, 0.0, -9.81};        ///< m/s^2, base frame
  std::vector<Actuator> actuators;         ///< four for ThreeUpsOneRpu, one to four for Axes, the chain's moving joints
  JointLimits joints;                      ///< only for ThreeUpsOneRpu
  double singularity_condition_max = 0.0;  ///< limit of conditionNumber(); infinity: margin wide open
  std::string urdf;                        ///< resolved path of the URDF, empty: none

  int axes() const { return static_cast<int>(actuators.size()); }
};

/// Reads a robot file strictly: unknown keys, missing keys, wrong types and impossible values are InputErrors that name
/// file, line and limit. `urdf: package://knee_robot/...` is looked up beside the sources, in ROS_PACKAGE_PATH, or in
/// KNEE_ROBOT_PATH; the URDF's existence is checked here, its content in dynamics/. A chain is refused: programs that
/// know what to do with one call loadAnyRobot.
Robot loadRobot(const std::string& path);
Robot loadAnyRobot(const std::string& path);

}  // namespace knee_robot::mechanism
