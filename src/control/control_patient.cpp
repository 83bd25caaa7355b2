// Whose leg is on the robot, and what follows from it.
#include <cmath>

#include "control_parts.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

constexpr double kLargestChange = 0.2;         // of a property's value when the patient was loaded
constexpr double kLargestPayloadChange = 2.0;  // kg
constexpr double kOpenMargin = 1e3;            // condition of dq/dx beyond which a margin protects nobody
constexpr double kWideAcceleration = 10.0;     // factor of the acceleration monitor that sees no collision any more

}  // namespace

std::optional<PatientLimits> ControlSystem::patient() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return parts_->patient;
}

/// Why nothing may move; empty: it may.
std::string ControlSystem::whyNobodyMoves() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (parts_->changing_occupancy) return "who is on the robot is just being changed; try again";
  if (parts_->occupancy != Occupancy::Unknown) return "";
  const std::string why =
      "nobody has said who is on the robot: load the patient's file (load_patient), or declare that "
      "nobody is on it (declare_empty)";
  return parts_->patient_refused.empty() ? why : parts_->patient_refused + "; " + why;
}

/// Only while disabled, and not while a request is under way that ends this.
Answer ControlSystem::usePatient(Occupancy occupancy, std::optional<PatientLimits> patient) {
  const MachineState now = state();
  if (started_ && now != MachineState::Disabled) {
    return {false, std::string("not possible while the robot is ") + toString(now) +
                       (now == MachineState::Faulted ? "; look at the robot and reset first" : "; disable it first")};
  }
  {
    // From here on nothing can be enabled: without occupancy nothing moves, and the disk may take its time.
    const std::lock_guard<std::mutex> lock(mutex_);
    if (parts_->powering > 0) return {false, "not possible while the robot is being enabled"};
    if (parts_->changing_occupancy) return {false, "somebody else is just saying who is on the robot; try again"};
    parts_->changing_occupancy = true;
  }
  std::string why;
  try {
    occupancy == Occupancy::Patient ? parts_->patient_memory.remember(patient->path) : parts_->patient_memory.forget();
  } catch (const std::exception& error) {
    why = std::string("who is on the robot cannot be remembered: ") + error.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  parts_->changing_occupancy = false;
  if (!why.empty()) return {false, why};
  parts_->occupancy = occupancy;
  parts_->patient = std::move(patient);
  parts_->patient_refused.clear();
  parts_->reference = trajectory::Points();  // it was checked for somebody else
  parts_->reference_name.clear();
  chooseTestPulses();
  parts_->monitors->setPatient(parts_->patient ? parts_->patient->range : PatientRange{});
  if (parts_->guide != nullptr) parts_->guide->setPatient(parts_->patient ? parts_->patient->range : PatientRange{});
  parts_->at_loading = properties();
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
    if (range.limitsForce() && !knowsForces())
      return {false, path +
                         ": force: its limits are judged by the residual of an identified model; start the controller "
                         "with one (model:=)"};
    const std::string obstacles = patientObstacles();
    // The simulated robot hurts nobody, and without this there would be no way to try patient files.
    if (!obstacles.empty() && hardware_.backend != "simulated")
      return {false, "no patient may be on this robot: " + obstacles};
    const Answer used = usePatient(Occupancy::Patient, std::move(patient));
    if (!used.ok) return used;
    const std::string note = obstacles.empty() ? "" : "; on a real robot this would be refused: " + obstacles;
    return {true, "patient " + name + ": at most " + shortNumber(1e3 * range.linear_m_per_s, 4) + " mm/s and " +
                      shortNumber(57.29577951308232 * range.angular_rad_per_s, 4) + " deg/s" + note};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

bool ControlSystem::knowsForces() const {
  return parts_->observer != nullptr && !parts_->observer->model.value().empty();
}

/// What stands against a patient on this machine as it is configured; each with what mends it.
std::string ControlSystem::patientObstacles() const {
  std::string all;
  const auto require = [&](bool fulfilled, const std::string& sentence) {
    if (!fulfilled) all += (all.empty() ? "" : "; ") + sentence;
  };
  require(bus_.isGuarded(), "no guardian watches this controller (start one, and name its link: guardian:=true)");
  const std::vector<std::string> lacking = warnings();
  require(lacking.empty(), "no real-time scheduling (" + (lacking.empty() ? "" : lacking.front()) + ")");
  require(hardware_.emergency_stop_clear_bit.has_value(),
          "no emergency stop is configured (hardware file: digital_inputs: emergency_stop_clear)");
  require(hardware_.hand_switch_clear_bit.has_value(),
          "no hand switch is configured (hardware file: digital_inputs: hand_switch_clear)");
  bool limited = true;
  for (const mechanism::Actuator& actuator : robot_.actuators)
    limited = limited && actuator.force_continuous_N > 0.0 && actuator.force_max_N > 0.0;
  require(limited, "an actuator has no force limits (robot file: force_continuous_N, force_max_N)");
  require(robot_.singularity_condition_max <= kOpenMargin,
          "the singularity margin is wide open (robot file: singularity_margin: condition_max)");
  const double factor = parts_->monitors->acceleration_factor;
  require(factor <= kWideAcceleration, "the acceleration monitor is opened wide (deployment: acceleration_factor " +
                                           shortNumber(factor) + ", at most " + shortNumber(kWideAcceleration) + ")");
  return all;
}

Answer ControlSystem::clearPatient() {
  const Answer used = usePatient(hardware_.bench_without_patient ? Occupancy::Empty : Occupancy::Unknown, std::nullopt);
  return used.ok ? Answer{true,
                          "no patient; nothing moves until the next one is loaded or declare_empty says that "
                          "nobody is on the robot"}
                 : used;
}

Answer ControlSystem::declareEmpty() {
  const Answer used = usePatient(Occupancy::Empty, std::nullopt);
  return used.ok ? Answer{true, "nobody is on the robot: only its own limits hold"} : used;
}

/// At the start: the patient of the last run is still there, whatever the command line says.
void ControlSystem::recallPatient() {
  try {
    const std::string path = parts_->patient_memory.remembered();
    if (!path.empty()) {
      PatientLimits patient = loadPatientLimits(path, robot_);
      const Answer used = usePatient(Occupancy::Patient, std::move(patient));
      if (!used.ok) parts_->patient_refused = used.sentence;
      return;
    }
  } catch (const std::exception& error) {
    parts_->patient_refused = std::string("the patient file of the last run cannot be loaded: ") + error.what();
    return;
  }
  if (!options_.empty && !hardware_.bench_without_patient) return;
  const Answer used = usePatient(Occupancy::Empty, std::nullopt);
  if (!used.ok) parts_->patient_refused = used.sentence;
}

/// With a patient loaded nothing may be changed far from what it was then, in however many steps.
Answer ControlSystem::allowChange(const std::string& component, const std::string& property,
                                  const std::string& value) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!parts_->patient) return {true, ""};
  for (const rt::PropertyReport& one : parts_->at_loading) {
    if (one.component != component || one.name != property) continue;
    char* end = nullptr;
    const double before = std::strtod(one.value.c_str(), &end);
    if (end == one.value.c_str()) return {true, ""};
    const double largest =
        one.unit == "kg" ? kLargestPayloadChange : kLargestChange * (before != 0.0 ? std::abs(before) : 1.0);
    const double change = std::abs(std::strtod(value.c_str(), nullptr) - before);
    if (change <= largest) return {true, ""};
    return {false, component + "." + property + " was " + one.value +
                       " when the patient was loaded and may be changed by " + shortNumber(largest) + " " + one.unit +
                       " at most while the patient is on the robot"};
  }
  return {true, ""};
}

}  // namespace knee_robot::control
