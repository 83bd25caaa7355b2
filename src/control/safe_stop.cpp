#include "safe_stop.h"

#include <algorithm>

namespace knee_robot::control {

void SafeStop::enter(SafeStopPhase phase, rt::Nanoseconds now) noexcept {
  phase_ = phase;
  entered_ = now;
  if (phase == SafeStopPhase::Done) ++completed_;
}

void SafeStop::trigger(rt::Nanoseconds now, bool released) noexcept {
  if (phase_ != SafeStopPhase::Idle) return;
  share_ = 1.0;
  holds_here_ = false;
  enter(released ? SafeStopPhase::Decelerating : SafeStopPhase::Disabling, now);
}

void SafeStop::step(rt::Nanoseconds now, bool loops_closed, bool at_rest, bool immediate,
                    const HoldView& hold) noexcept {
  const bool carried = loops_closed && !immediate;
  const rt::Nanoseconds elapsed = now - entered_;
  switch (phase_) {
    case SafeStopPhase::Idle:
    case SafeStopPhase::Done:
      return;
    case SafeStopPhase::Decelerating:
      if (!carried) return enter(SafeStopPhase::Engaging, now);
      if (at_rest || elapsed >= timing_.decelerate_limit) enter(SafeStopPhase::Settling, now);
      return;
    case SafeStopPhase::Settling:
      if (!carried || elapsed >= timing_.settle) enter(SafeStopPhase::Engaging, now);
      return;
    case SafeStopPhase::Engaging:
      again_ = hold.again;
      if (!hold.ordered && !immediate) return enter(SafeStopPhase::Engaging, now);
      if (elapsed < timing_.hold_delay) return;
      if (immediate || timing_.transfer <= 0 || !(carried || hold.watched) || hold.runs)
        return enter(SafeStopPhase::Disabling, now);
      holds_here_ = holds_here_ || !carried;
      if (!carried && !hold.stands && elapsed < timing_.hold_delay + timing_.stand_limit) return;
      return enter(SafeStopPhase::Transferring, now);
    case SafeStopPhase::Transferring:
      if (immediate || hold.runs) return enter(SafeStopPhase::Disabling, now);
      if (hold.slipped) {
        share_ = 1.0;
        return enter(SafeStopPhase::Carrying, now);
      }
      share_ = std::max(0.0, 1.0 - static_cast<double>(elapsed) / static_cast<double>(timing_.transfer));
      if (elapsed >= timing_.transfer + (hold.creeps ? timing_.creep_watch : timing_.watch))
        enter(SafeStopPhase::Disabling, now);
      return;
    case SafeStopPhase::Carrying:
      if (immediate || hold.runs) return enter(SafeStopPhase::Disabling, now);
      if (hold.again != again_) enter(SafeStopPhase::Transferring, now);
      again_ = hold.again;
      return;
    case SafeStopPhase::Disabling:
      if (elapsed >= timing_.disable_delay) enter(SafeStopPhase::Done, now);
      return;
  }
}

void SafeStop::finishAtOnce() noexcept {
  if (phase_ != SafeStopPhase::Done) enter(SafeStopPhase::Done, entered_);
}

void SafeStop::rearm() noexcept {
  if (phase_ != SafeStopPhase::Done) return;
  phase_ = SafeStopPhase::Idle;
  share_ = 1.0;
  holds_here_ = false;
}

}  // namespace knee_robot::control
