#include "occupancy_record.h"

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::control {
namespace {

/// What is used is what is compared: a file can change between two looks at it. Throws InputError.
PatientLimits loadAsItWas(const PatientMemory::File& was, const mechanism::Robot& robot) {
  const std::string other = was.path + " is not what it was when the patient was loaded: load it again";
  if (was.mark != fingerprint(readFile(was.path))) throw InputError(other);  // before what may be wrong in it
  PatientLimits patient = loadPatientLimits(was.path, robot);
  if (patient.mark != was.mark) throw InputError(other);
  return patient;
}

}  // namespace

OccupancyRecord::Hold::Hold(OccupancyRecord& record)
    : record_(record), held_([&record] {
        const std::lock_guard<std::mutex> lock(record.mutex_);
        if (record.changing_) return false;
        ++record.holds_;
        return true;
      }()) {}

OccupancyRecord::Hold::~Hold() {
  if (!held_) return;
  const std::lock_guard<std::mutex> lock(record_.mutex_);
  --record_.holds_;
}

/// From here on nothing is asked of the machine, and the disk may take its time.
Answer OccupancyRecord::beginChange() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (holds_ > 0) return {false, "not possible while something is asked of the robot; try again"};
  if (changing_) return {false, "another client is changing the occupancy; try again"};
  changing_ = true;
  return {true, ""};
}

/// Empty, or why it cannot be.
std::string OccupancyRecord::remember(Occupancy occupancy, const std::optional<PatientLimits>& patient) const {
  try {
    occupancy == Occupancy::Patient ? memory_.remember({patient->path, patient->mark}) : memory_.forget();
    return "";
  } catch (const std::exception& error) {
    return std::string("who is on the robot cannot be remembered: ") + error.what();
  }
}

Answer OccupancyRecord::change(Occupancy occupancy, std::optional<PatientLimits> patient, const WhyNotNow& why_not) {
  if (const std::string why = why_not_now_(); !why.empty()) return {false, why};
  if (const Answer begun = beginChange(); !begun.ok) return begun;
  // Whatever was asked before is seen now: the first look may have been too early.
  std::string why = why_not_now_();
  if (why.empty() && why_not) why = why_not();
  if (why.empty()) why = remember(occupancy, patient);
  const std::lock_guard<std::mutex> lock(mutex_);
  changing_ = false;
  if (!why.empty()) return {false, why};
  occupancy_ = occupancy;
  patient_ = std::move(patient);
  refused_.clear();
  changed_(occupancy_, patient_ ? patient_->range : PatientRange{});
  return {true, ""};
}

void OccupancyRecord::recall(const mechanism::Robot& robot, bool declared_empty,
                             const std::function<Answer(const PatientLimits&)>& admits) {
  Answer used{true, ""};
  try {
    const PatientMemory::File was = memory_.remembered();
    if (!was.path.empty()) {
      const PatientLimits patient = loadAsItWas(was, robot);
      used = admits(patient);
      if (used.ok) used = change(Occupancy::Patient, patient);
      if (!used.ok) used.sentence = "the patient of the last run, " + patient.name + ": " + used.sentence;
    } else if (declared_empty) {
      used = change(Occupancy::Empty, std::nullopt);
    }
  } catch (const std::exception& error) {
    used = {false, std::string("the patient file of the last run cannot be loaded: ") + error.what()};
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!used.ok) refused_ = used.sentence;
}

void OccupancyRecord::keep() {
  if (!patient() || memory_.isThere()) return;  // a hold refuses whoever comes meanwhile
  const Hold hold(*this);                       // nobody leaves meanwhile, and is remembered all the same
  const std::optional<PatientLimits> now = patient();
  if (hold && now) remember(Occupancy::Patient, now);
}

std::string OccupancyRecord::whyNobodyMoves() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (changing_) return "the occupancy is being changed; try again";
  if (occupancy_ != Occupancy::Unknown) return "";
  const std::string why =
      "nobody has said who is on the robot: load the patient's file (load_patient), or declare that "
      "nobody is on it (declare_empty)";
  return refused_.empty() ? why : refused_ + "; " + why;
}

std::optional<PatientLimits> OccupancyRecord::patient() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return patient_;
}

Occupancy OccupancyRecord::occupancy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return occupancy_;
}

void OccupancyRecord::fill(ControlStatus& status) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  status.occupancy = occupancy_;
  if (patient_) status.patient = patient_->name;
}

}  // namespace knee_robot::control
