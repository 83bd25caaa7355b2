#include "patient_checklist.h"

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot::control {
namespace {

constexpr double kOpenMargin = 1e3;         // condition of dq/dx beyond which a margin protects nobody
constexpr double kLongestSilence_s = 0.1;   // meanwhile the drives go on with the last voltage
constexpr double kWideAcceleration = 10.0;  // factor of the acceleration monitor that sees no collision any more

}  // namespace

PatientChecklist::PatientChecklist(const mechanism::Robot& robot, const HardwareFile& hardware)
    : hardware_path(hardware.path),
      bench_without_patient(hardware.bench_without_patient),
      simulated(hardware.backend == "simulated"),
      has_emergency_stop(hardware.emergency_stop_clear_bit.has_value()),
      has_hand_switch(hardware.hand_switch_clear_bit.has_value()),
      has_force_limits(!robot.actuators.empty()),
      singularity_condition_max(robot.singularity_condition_max) {
  if (hardware.can) {
    for (const auto& drive : hardware.can->drives)
      knows_its_drives = knows_its_drives && drive.serial.has_value();
  }
  for (const mechanism::Actuator& actuator : robot.actuators)
    has_force_limits = has_force_limits && actuator.force_continuous_N > 0.0 && actuator.force_max_N > 0.0;
}

std::string PatientChecklist::whyNever() const {
  return bench_without_patient ? hardware_path + " says bench_without_patient: nothing may carry a patient here" : "";
}

std::string PatientChecklist::obstacles() const {
  std::string all;
  const auto require = [&](bool fulfilled, const std::string& sentence) {
    if (!fulfilled) all += (all.empty() ? "" : "; ") + sentence;
  };
  require(guarded, "no guardian watches this controller (start one, and name its link: guardian:=true)");
  require(allowed_silence_s <= kLongestSilence_s, "guardian and controller allow each other a silence of " +
                                                      shortNumber(1e3 * allowed_silence_s) + " ms, at most " +
                                                      shortNumber(1e3 * kLongestSilence_s) +
                                                      " (guardian_silence_ms, silent_guardian_ms of the launch file)");
  const std::string lacking = lacking_privileges.empty() ? "" : lacking_privileges.front();
  require(lacking_privileges.empty(), "no real-time scheduling (" + lacking + ")");
  require(has_emergency_stop, "no emergency stop is configured (hardware file: digital_inputs: emergency_stop_clear)");
  require(has_hand_switch, "no hand switch is configured (hardware file: digital_inputs: hand_switch_clear)");
  require(has_force_limits, "an actuator has no force limits (robot file: force_continuous_N, force_max_N)");
  require(singularity_condition_max <= kOpenMargin,
          "the singularity margin is wide open (robot file: singularity_margin: condition_max)");
  require(acceleration_factor <= kWideAcceleration,
          "the acceleration monitor is opened wide (deployment: acceleration_factor " +
              shortNumber(acceleration_factor) + ", at most " + shortNumber(kWideAcceleration) + ")");
  require(
      knows_its_drives,
      "a drive has no serial number (hardware file: can: drives: serial); two drives that were exchanged would each "
      "move the other's leg");
  require(asks_encoders,
          "a Driver never tests whether its encoder counts (deployment: probe_s 0, as for commissioning)");
  require(opened_wide.empty(), "the deployment opens limits wide: " + joined(opened_wide));
  require(strange_weights.empty(), strange_weights);
  return all;
}

Answer PatientChecklist::admit(const PatientLimits& patient) const {
  if (const std::string why = whyNever(); !why.empty()) return {false, why};
  if (patient.range.limitsForce() && !monitors_forces)
    return {false, patient.path +
                       ": force: its limits are monitored by the residual of an identified model; start the controller "
                       "with one (model:=)"};
  const std::string missing = obstacles();
  if (missing.empty()) return {true, ""};
  // The simulated robot hurts nobody, and without this there would be no way to try patient files.
  if (!simulated) return {false, "no patient may be on this robot: " + missing};
  return {true, "on a real robot this would be refused: " + missing};
}

}  // namespace knee_robot::control
