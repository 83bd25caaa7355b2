#pragma once

#include <array>
#include <atomic>

#include "knee_robot/control/guardian_hand_over.h"
#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/hardware/guardian_link.h"
#include "knee_robot/hardware/process_watch.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::control {

enum class GuardianCause : std::uint8_t { None, Silent, ProcessGone, LockedOut };

/// What the guardian does in one cycle.
enum class GuardianAction : std::uint8_t {
  Watch,     ///< nothing: the controller is healthy, or nothing is switched on
  Trip,      ///< fence the controller out and bring the outputs down
  KeepDown,  ///< bring them down again: somebody may have come back
  Release,   ///< give the outputs back
};

/// What the guardian sees in one cycle.
struct GuardianView {
  rt::Nanoseconds now = 0;
  std::uint64_t heartbeat = 0;
  bool armed = false;         ///< drives enabled or holding brakes released
  bool process_gone = false;  ///< the controller's process has ended
  bool reset_asked = false;   ///< the controller asks for the outputs
  bool hands_over = false;    ///< the drives still carry, and the brakes are being watched: nothing is given back
  bool fenced = false;        ///< somebody has locked the controller out (--down-now), and leaves the rest to this one
};

/// Decides when a controller counts as dead. Silence counts only while drives are on, and a cycle of the guardian adds
/// at most two of its periods: when the machine (or the guardian) has paused, a controller that could not run either
/// gets the same time again. Latched until the controller asks for a reset with everything switched off. Pure: no
/// clock, no hardware; real-time safe.
class GuardianWatch {
 public:
  GuardianWatch(rt::Nanoseconds silence_limit, rt::Nanoseconds period, bool tripped = false)
      : silence_limit_(silence_limit), period_(period), tripped_(tripped) {}

  GuardianAction step(const GuardianView& view) noexcept;
  GuardianCause cause() const noexcept { return cause_; }
  /// When the heartbeat was last seen to move.
  rt::Nanoseconds lastHeartbeat() const noexcept { return last_heartbeat_; }
  /// This watch has seen a controller at work: the heartbeat has moved since it began to look.
  bool hasHeard() const noexcept { return heard_; }

 private:
  void listen(const GuardianView& view) noexcept;

  rt::Nanoseconds silence_limit_;
  rt::Nanoseconds period_;
  bool tripped_;
  bool any_ = false;
  bool heard_ = false;
  std::uint64_t heartbeat_ = 0;
  rt::Nanoseconds last_step_ = 0;
  rt::Nanoseconds last_heartbeat_ = 0;
  rt::Nanoseconds silence_ = 0;
  GuardianCause cause_ = GuardianCause::None;
};

/// What happened last, for the thread that reports: written before `count`.
struct GuardianReport {
  std::atomic<std::uint32_t> trips{0};
  std::atomic<std::uint32_t> releases{0};
  std::atomic<GuardianCause> cause{GuardianCause::None};
  std::atomic<std::int32_t> controller_pid{0};
  std::atomic<rt::Nanoseconds> reaction{0};  ///< from the last heartbeat seen until the holding brakes were ordered
  std::atomic<rt::Nanoseconds> carried{0};   ///< for so long the drives carry the load from then on; 0: down at once
  std::atomic<int> slipped{0};               ///< axis, 1 to 4, whose brake held too late, if at all; 0: none did
  std::atomic<rt::Nanoseconds> writing{0};   ///< the part of it that the writes took
  std::atomic<bool> written{true};           ///< the cards took all writes
  std::atomic<bool> found_nobody{false};     ///< no controller lived at the start: outputs brought down
  std::atomic<bool> went_on{false};          ///< at the start, with what a guardian carried that died of it
  std::atomic<bool> acts{false};             ///< from before a trip until the outputs are down: now it must not end
};

/// What the drives do between a trip and 0 V: they give what carried the robot at rest (GuardianLink::load_V), until
/// the holding brakes do (GuardianHandOver).
/// Without it a platform falls by 6 mm while brakes of 50 ms engage. Only what is on may stay on: what the link says may
/// be a dead controller's, of drives that are off since. So a guardian that has not itself seen the controller at work
/// believes in a load, or in what another guardian carried, for two seconds only: nobody else switches anything then. As
/// long as the card with the digital outputs does not answer, no brake engages, and the drives go on.
struct GuardianCarry {
  std::uint8_t outputs = 0;  ///< digital outputs meanwhile: drives on, holding brakes ordered to engage
  std::uint8_t heartbeat =
      0;                     ///< output that is toggled in every cycle: a relay that watches it keeps the drives' power
  rt::Nanoseconds time = 0;  ///< what the slowest holding brake takes; 0: down at once
  bool watches = true;       ///< brakes hold each axis: none may move while the load is handed over to them
};

/// The guardian's cycle: looks at the link and at the controller's process, and brings the outputs down when it is
/// dead, and once at its own start unless a controller lives that holds the link. Never writes to the cards otherwise.
/// One a robot, in a process of its own with higher priority than the controller's.
class Guardian : public rt::TaskContext {
 public:
  /// All must outlive this. `clock` gives ns; the cycle's wake and `clock` count from one zero.
  Guardian(hardware::GuardianLink& link, hardware::EmergencyOutputs& outputs, rt::Nanoseconds silence_limit,
           rt::Nanoseconds period, rt::Nanoseconds (*clock)() noexcept, GuardianCarry carry = {});

  const GuardianReport& report() const noexcept { return report_; }
  /// Another process is the guardian in the link now: this one stood still, and does nothing any more.
  bool isReplaced() const noexcept { return link_.guardian_pid.load() != pid_; }

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void arrive(bool nobody) noexcept;
  bool goesOn() noexcept;
  bool isLately(const std::atomic<std::int64_t>& at_ns) const noexcept;
  void trip() noexcept;
  bool carryLoad() noexcept;
  bool writeCarry() noexcept;
  bool isStranded() noexcept;
  void handOver(rt::Nanoseconds now) noexcept;
  void keepDown(rt::Nanoseconds now) noexcept;
  void setActs(bool acts) noexcept;

  hardware::GuardianLink& link_;
  hardware::EmergencyOutputs& outputs_;
  rt::Nanoseconds (*clock_)() noexcept;
  GuardianWatch watch_;
  hardware::ProcessWatch process_;
  const GuardianCarry carry_;
  GuardianHandOver hand_over_;
  hardware::BrakeWatch slip_;
  std::array<double, hardware::kChannels> load_V_{};
  bool orders_ = true;  // the brakes have been ordered to engage
  bool beat_ = false;
  bool first_cycle_ = true;
  std::int32_t pid_ = 0;
  GuardianReport report_;
};

}  // namespace knee_robot::control
