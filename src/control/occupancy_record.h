#pragma once

#include <functional>
#include <mutex>
#include <optional>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/control_status.h"
#include "knee_robot/control/patient_limits.h"
#include "knee_robot/control/patient_memory.h"

namespace knee_robot::control {

/// Who is on the robot, from one start of the controller to the next. Nothing moves before somebody has said it, and
/// nobody else is put there while something is asked of the machine. Any thread.
class OccupancyRecord {
 public:
  /// Keeps who is on the robot as it is for as long as it lives: what is checked for a patient is done for that
  /// patient.
  class Hold {
   public:
    /// False where it is just being changed.
    explicit Hold(OccupancyRecord& record);
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
    explicit operator bool() const { return held_; }

   private:
    OccupancyRecord& record_;
    const bool held_;
  };

  /// Why nobody may come or go now, empty: he may. Called without any lock held.
  using WhyNotNow = std::function<std::string()>;
  /// Somebody else is on the robot: every part that was told of the one before is told. Nobody can ask for anything
  /// meanwhile.
  using Changed = std::function<void(Occupancy occupancy, const PatientRange& range)>;

  OccupancyRecord(PatientMemory memory, WhyNotNow why_not_now, Changed changed)
      : memory_(std::move(memory)), why_not_now_(std::move(why_not_now)), changed_(std::move(changed)) {}

  /// Remembers first, then tells. What cannot be remembered changes nothing. `why_not`: further reasons, asked when
  /// nobody changes the machine any more.
  Answer change(Occupancy occupancy, std::optional<PatientLimits> patient, const WhyNotNow& why_not = nullptr);
  /// At the start: the patient of the last run is still there, whatever `declared_empty` says. Where he cannot be
  /// loaded, or `admits` refuses him on the machine as it is now, nobody moves.
  void recall(const mechanism::Robot& robot, bool declared_empty,
              const std::function<Answer(const PatientLimits&)>& admits);

  /// Writes down anew who is on the robot where somebody has removed the file; for an ordinary thread, now and then.
  void keep();

  /// Why nothing may move; empty: it may.
  std::string whyNobodyMoves() const;
  std::optional<PatientLimits> patient() const;
  Occupancy occupancy() const;
  /// Fills in occupancy and patient.
  void fill(ControlStatus& status) const;

 private:
  Answer beginChange();
  std::string remember(Occupancy occupancy, const std::optional<PatientLimits>& patient) const;

  const PatientMemory memory_;
  const WhyNotNow why_not_now_;
  const Changed changed_;
  mutable std::mutex mutex_;  // of what follows
  Occupancy occupancy_ = Occupancy::Unknown;
  std::optional<PatientLimits> patient_;
  std::string refused_;    // why the patient of the last run is not loaded
  bool changing_ = false;  // nothing is asked of the machine
  int holds_ = 0;          // requests under way: nobody comes or goes
};

}  // namespace knee_robot::control
