// Whose leg is on the robot, and what follows from it.
#include "control_parts.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {

std::optional<PatientLimits> ControlSystem::patient() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return parts_->patient;
}

Answer ControlSystem::usePatient(std::optional<PatientLimits> patient) {
  const MachineState now = state();
  if (started_ && now != MachineState::Disabled && now != MachineState::Faulted) {
    return {false, std::string("not possible while the robot is ") + toString(now) + "; disable it first"};
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  parts_->patient = std::move(patient);
  parts_->reference = trajectory::Points();  // it was checked for somebody else
  parts_->reference_name.clear();
  parts_->monitors->setPatient(parts_->patient ? parts_->patient->range : PatientRange{});
  return {true, ""};
}

Answer ControlSystem::loadPatient(const std::string& path) {
  if (hardware_.bench_without_patient) {
    return {false, hardware_.path + " says bench_without_patient: nothing may carry a patient here"};
  }
  try {
    PatientLimits patient = loadPatientLimits(path, robot_);
    const PatientRange range = patient.range;
    const std::string name = patient.name;
    const Answer used = usePatient(std::move(patient));
    if (!used.ok) return used;
    return {true, "patient " + name + ": at most " + shortNumber(1e3 * range.linear_m_per_s, 4) + " mm/s and " +
                      shortNumber(57.29577951308232 * range.angular_rad_per_s, 4) + " deg/s"};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

Answer ControlSystem::clearPatient() {
  const Answer used = usePatient(std::nullopt);
  return used.ok ? Answer{true, "no patient: only the robot's own limits hold"} : used;
}

}  // namespace knee_robot::control
