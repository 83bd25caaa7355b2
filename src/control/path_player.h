#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "knee_robot/control/path_expectation.h"
#include "knee_robot/control/patient_limits.h"
#include "knee_robot/control/playable_reference.h"
#include "machine_requests.h"

namespace knee_robot::control {

/// The loaded reference, and what is being played: it, or the approach to its first point. Nothing gets to Sync that
/// the checks of the robot and of the patient have not seen. Any thread.
class PathPlayer {
 public:
  using Patient = std::optional<PatientLimits>;

  /// All must outlive this.
  PathPlayer(const mechanism::Robot& robot, Sync& sync, const OperatorPanel& panel, MachineRequests& requests)
      : robot_(robot), sync_(sync), panel_(panel), requests_(requests) {}

  /// InputError: the first limit of the robot that it breaks.
  PlayableReference check(trajectory::Reference reference) const;
  /// Keeps what check() let pass in place of the one before, when the patient's limits allow it: whoever is on the robot
  /// may have changed since.
  Answer load(const PlayableReference& playable, const Patient& patient);
  /// Nothing is loaded: what was, was checked for somebody else.
  void forget();
  /// Somebody wants the robot to stand: called before the Supervisor is asked for it.
  void halt() noexcept {
    last_wish_ = rt::monotonicNow();
    ++halts_;
  }
  std::uint64_t halts() const noexcept { return halts_; }
  /// Somebody wants it to wait, or another speed: called before the Supervisor is asked for it, too.
  void pause() noexcept {
    last_wish_ = rt::monotonicNow();
    ++pauses_;
  }
  void setSpeed() noexcept { ++speeds_; }
  std::uint64_t pauses() const noexcept { return pauses_; }
  std::uint64_t speeds() const noexcept { return speeds_; }
  rt::Nanoseconds lastWish() const noexcept { return last_wish_; }
  /// PlayableReference::number() of what is loaded; 0: nothing.
  std::uint64_t loaded() const noexcept { return loaded_; }
  /// The loaded reference from its first point.
  Answer play(const PathExpectation& wanted = {});
  /// From where the robot stands to the first point of the loaded reference; slower than `speed_m_per_s` where the
  /// patient wants it.
  Answer approach(double speed_m_per_s, const Patient& patient, const PathExpectation& wanted = {});
  /// Fills in reference and at_start, and, when `status.state` is of a robot on a path, playing.
  void fill(ControlStatus& status) const;

 private:
  Answer playLengths(const trajectory::Points& lengths, const std::string& what, const PathExpectation& expected);
  PathExpectation fromNow(PathExpectation expected) const;
  bool standsAtStart() const;
  std::string whyNot(const PathExpectation& expected) const;
  bool isHalted(const PathExpectation& expected) const { return expected.halts != halts(); }
  bool isPaused(const PathExpectation& expected) const { return expected.pauses != pauses(); }

  const mechanism::Robot& robot_;
  Sync& sync_;
  const OperatorPanel& panel_;
  MachineRequests& requests_;
  std::atomic<std::uint64_t> halts_{0}, pauses_{0}, speeds_{0};
  std::atomic<rt::Nanoseconds> last_wish_{0};
  std::atomic<std::uint64_t> loaded_{0};  // changed under mutex_
  std::mutex begin_;                      // from the offer of a path to the answer: what is begun is what was offered
  mutable std::mutex mutex_;              // of what follows
  std::string name_;
  trajectory::Points lengths_;  // of the loaded reference; empty: none
  std::string playing_;         // what was played last
};

}  // namespace knee_robot::control
