#include "knee_robot/control/safe_stop.h"

namespace knee_robot::control {

void SafeStop::enter(SafeStopPhase phase, rt::Nanoseconds now) noexcept {
  phase_ = phase;
  entered_ = now;
  if (phase == SafeStopPhase::Done) ++completed_;
}

void SafeStop::trigger(rt::Nanoseconds now, bool released) noexcept {
  if (phase_ != SafeStopPhase::Idle) return;
  enter(released ? SafeStopPhase::Decelerating : SafeStopPhase::Disabling, now);
}

void SafeStop::step(rt::Nanoseconds now, bool loops_closed, bool at_rest, bool immediate) noexcept {
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
      if (elapsed >= timing_.hold_delay) enter(SafeStopPhase::Disabling, now);
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
  if (phase_ == SafeStopPhase::Done) phase_ = SafeStopPhase::Idle;
}

}  // namespace knee_robot::control
