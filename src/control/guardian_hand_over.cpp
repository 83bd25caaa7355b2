#include "knee_robot/control/guardian_hand_over.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {

void GuardianHandOver::enter(Phase phase, rt::Nanoseconds now) noexcept {
  phase_ = phase;
  entered_ = now;
  share_ = phase == Phase::Over ? 0.0 : 1.0;
}

void GuardianHandOver::begin(rt::Nanoseconds now, rt::Nanoseconds hold, const Counts& slip) noexcept {
  began_ = now;
  hold_ = hold;
  slip_ = slip;
  slipped_ = 0;
  watched_ = std::all_of(slip.begin(), slip.end(), [](std::int32_t one) { return one > 0; });
  enter(Phase::Engaging, now);
}

/// First axis, from 1, that is farther from where it was than so many slips; 0: none. Counters may overflow.
int GuardianHandOver::moved(const Counts& from, const Counts& to, std::int32_t slips) const noexcept {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto way = static_cast<std::int32_t>(static_cast<std::uint32_t>(to[i]) - static_cast<std::uint32_t>(from[i]));
    if (std::abs(static_cast<double>(way)) > static_cast<double>(slip_[i]) * slips) return static_cast<int>(i) + 1;
  }
  return 0;
}

void GuardianHandOver::step(rt::Nanoseconds now, const Counts* counts) noexcept {
  const rt::Nanoseconds elapsed = now - entered_;
  watched_ = watched_ && counts != nullptr;
  if (phase_ == Phase::Over || (phase_ == Phase::Engaging && elapsed < hold_)) return;
  if (!watched_ || now - began_ >= hold_ + kLongest) return enter(Phase::Over, now);
  if (phase_ == Phase::Engaging) held_ = *counts;
  if (moved(held_, *counts, kFarthest) != 0) return enter(Phase::Over, now);
  if (phase_ == Phase::Engaging || (phase_ == Phase::Carrying && elapsed >= kAgain)) {
    from_ = *counts;
    return enter(Phase::Transferring, now);
  }
  if (phase_ == Phase::Carrying) return;
  if (const int axis = moved(from_, *counts, 1); axis != 0) {
    if (slipped_ == 0) slipped_ = axis;
    return enter(Phase::Carrying, now);
  }
  share_ = std::max(0.0, 1.0 - static_cast<double>(elapsed) / static_cast<double>(kTransfer));
  if (elapsed >= kTransfer + kWatch) enter(Phase::Over, now);
}

}  // namespace knee_robot::control
