#pragma once

#include <string>
#include <vector>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/patient_limits.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::control {

/// What must be so before a patient may lie in a machine (docs/safety.md). Plain facts; the default is a machine that
/// no patient may be on.
struct PatientChecklist {
  std::string hardware_path;
  bool bench_without_patient = false;
  bool simulated = false;  ///< hurts nobody; what is missing is only told
  bool monitors_forces = false;
  bool guarded = false;                         ///< a guardian watches the controller
  double allowed_silence_s = 0.0;               ///< AxisBus::allowedSilence()
  std::vector<std::string> lacking_privileges;  ///< real-time ones
  bool has_emergency_stop = false, has_hand_switch = false;
  bool knows_its_drives = true;            ///< each drive on a bus is told from the others by its serial number
  bool has_force_limits = false;           ///< all actuators
  double singularity_condition_max = 0.0;  ///< of dq/dx
  double acceleration_factor = 0.0;        ///< of the acceleration monitor
  bool asks_encoders = false;              ///< every Driver asks its encoder whether it counts
  std::vector<std::string> opened_wide;    ///< limits of the deployment (limitsOpenedWide)
  std::string strange_weights;             ///< in which the model differs from the URDF (FeedforwardSetup)

  /// The facts that a robot and a hardware file know.
  PatientChecklist(const mechanism::Robot& robot, const HardwareFile& hardware);

  /// A bench carries nobody, whoever it is: a sentence, or empty.
  std::string whyNever() const;
  /// What stands against a patient, each with what mends it; empty: nothing.
  std::string obstacles() const;
  /// Whether this patient may be on the machine; ok: what the operator should know besides, or nothing.
  Answer admit(const PatientLimits& patient) const;
};

}  // namespace knee_robot::control
