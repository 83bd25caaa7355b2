#pragma once

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// What is known of the holding brakes in a cycle.
struct HoldView {
  bool ordered = true;      ///< the output that engages them can be written
  bool slipped = false;     ///< an axis has moved since the transfer began
  std::uint32_t again = 0;  ///< a new number: hand over the load again
  bool creeps = false;      ///< an axis still moves although the drives give no force any more
  bool watched = false;     ///< of loops that do not all work, one is left that could take its load back
  bool stands = true;       ///< no axis moves
  bool runs = false;        ///< an axis without a loop runs away in spite of its brake: its drive must go off
};

/// How long each phase of the safe stop lasts, ns.
struct SafeStopTiming {
  rt::Nanoseconds decelerate_limit = 1'000'000'000;  ///< longest wait for the reference to come to rest
  rt::Nanoseconds settle = 50'000'000;               ///< holding at rest before the holding brakes engage
  rt::Nanoseconds hold_delay = 0;                    ///< until the slowest holding brake holds
  rt::Nanoseconds stand_limit = 50'000'000;          ///< longest wait for axes that were braked in motion to stand
  rt::Nanoseconds transfer = 0;                      ///< the force goes down in so long, watched; 0: in one step
  rt::Nanoseconds watch = 20'000'000;                ///< without force, still watched
  rt::Nanoseconds creep_watch = 500'000'000;         ///< the same as long as an axis creeps
  rt::Nanoseconds disable_delay = 20'000'000;        ///< until a disabled drive gives no torque
};

/// The order in which the machine is brought to rest; zero volts is not rest, it is zero force, and the platform would
/// fall:
///
///     Decelerating  along the path, position loops closed        (left out when a loop is not closed any more)
///     Settling      hold at rest                                 (likewise)
///     Engaging      holding brakes engage; loops go on until the slowest device holds. Where it was no deceleration
///                   that ended here, the loops that are left then hold where the axes are
///     Transferring  the drives' force goes down to nothing while the positions are watched
///     Carrying      an axis moved: its holding brake does not hold. The drives take the load back and keep it until
///                   they are asked to hand it over again, or have no power any more; an axis whose loop fails
///                   meanwhile keeps its load estimate
///     Disabling     drives disabled; set values stay until the drives are off
///     Done          0 V
///
/// Transferring needs a loop that works when it begins; without one it is left out, and the set values stay until the
/// drives are off. A loop that fails meanwhile, or in Carrying, does not end the watch, unless its axis runs away.
/// Holding brakes that cannot be ordered to engage (the output card is gone) end it in Engaging: 0 V would let the
/// platform fall.
///
/// One state machine for all four channels, so they go together. trigger() any number of times runs it once, until
/// rearm().
/// Pure: no clock, no hardware; real-time safe.
class SafeStop {
 public:
  explicit SafeStop(const SafeStopTiming& timing) : timing_(timing) {}

  /// Begins. `released`: the holding brakes are open and the Drivers carry the platform; otherwise there is nothing to
  /// decelerate and the drives are disabled at once.
  void trigger(rt::Nanoseconds now, bool released) noexcept;
  /// One cycle. `loops_closed`: all four position loops work. `at_rest`: all four references stand still. `immediate`:
  /// do not decelerate (drive power is gone).
  void step(rt::Nanoseconds now, bool loops_closed, bool at_rest, bool immediate, const HoldView& hold = {}) noexcept;
  /// To the end without waiting: for a component that will not be called again.
  void finishAtOnce() noexcept;
  /// Done -> Idle: the next trigger() runs again.
  void rearm() noexcept;

  SafeStopPhase phase() const noexcept { return phase_; }
  bool isRunning() const noexcept { return phase_ != SafeStopPhase::Idle && phase_ != SafeStopPhase::Done; }
  bool engagesHold() const noexcept { return phase_ >= SafeStopPhase::Engaging; }
  bool disablesDrive() const noexcept { return phase_ >= SafeStopPhase::Disabling; }
  bool isTransferring() const noexcept { return phase_ == SafeStopPhase::Transferring; }
  /// The brakes should hold, and no deceleration brought the axes there: no path is followed any more.
  bool holdsHere() const noexcept { return holds_here_; }
  /// Of the set values that may be written now: 1, less while the load is handed over, 0 when it has been.
  double share() const noexcept { return share_; }
  std::uint32_t completed() const noexcept { return completed_; }

 private:
  void enter(SafeStopPhase phase, rt::Nanoseconds now) noexcept;

  SafeStopTiming timing_;
  SafeStopPhase phase_ = SafeStopPhase::Idle;
  rt::Nanoseconds entered_ = 0;
  double share_ = 1.0;
  bool holds_here_ = false;
  std::uint32_t again_ = 0;
  std::uint32_t completed_ = 0;
};

}  // namespace knee_robot::control
