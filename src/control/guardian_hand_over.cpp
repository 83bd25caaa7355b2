#include "knee_robot/control/guardian_hand_over.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/hardware/axis_bus.h"

namespace knee_robot::control {
namespace {

constexpr double kNoise_mm = 0.5;                       // from one ms to the next: 50 g
constexpr rt::Nanoseconds kLongestStep = 3'000'000;     // after a pause anything may have moved
constexpr double kShareOfMean = 0.05, kDoubtful = 3.0;  // AxesOutput's: some 20 ms; five standard errors of +-2 mm

}  // namespace

void GuardianHandOver::enter(Phase phase, rt::Nanoseconds now) noexcept {
  phase_ = phase;
  entered_ = now;
  share_ = phase == Phase::Over ? 0.0 : 1.0;
}

void GuardianHandOver::begin(rt::Nanoseconds now, rt::Nanoseconds hold, const hardware::BrakeWatch& watch) noexcept {
  began_ = now;
  hold_ = hold;
  watch_ = watch;
  slipped_ = 0;
  looks_ = 0;
  noisy_.fill(false);
  watched_ = std::all_of(watch.slip_counts.begin(), watch.slip_counts.end(), [](std::int32_t one) { return one > 0; });
  enter(Phase::Engaging, now);
}

/// Where the axes are. Counters may overflow.
void GuardianHandOver::look(rt::Nanoseconds now, const Counts& counts) noexcept {
  const bool first = looks_ == 0;
  const bool follows = !first && now - looked_ <= kLongestStep;
  looks_ = follows ? std::min(looks_ + 1, 3) : 1;
  looked_ = now;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double way = first ? 0.0 : static_cast<double>(hardware::countDifference(counts[i], last_[i]));
    position_[i] = first ? 0.0 : position_[i] + way;
    mean_[i] = follows ? mean_[i] + kShareOfMean * (position_[i] - mean_[i]) : position_[i];
    noisy_[i] = noisy_[i] || (looks_ == 3 && std::abs(way - way_[i]) > kNoise_mm * watch_.counts_per_mm[i]);
    place_[i] = noisy_[i] ? mean_[i] : position_[i];
    way_[i] = way;
    last_[i] = counts[i];
  }
}

/// First axis, from 1, that is farther from where the transfer began than a brake lets it go; 0: none.
int GuardianHandOver::slips() const noexcept {
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const double slip = static_cast<double>(watch_.slip_counts[i]) * (noisy_[i] ? kDoubtful : 1.0);
    if (std::abs(place_[i] - from_[i]) > slip) return static_cast<int>(i) + 1;
  }
  return 0;
}

bool GuardianHandOver::isTooFar() const noexcept {
  bool far = false;
  for (std::size_t i = 0; i < place_.size(); ++i)
    far = far || std::abs(place_[i] - held_[i]) > kFarthest_mm * watch_.counts_per_mm[i];
  return far;
}

void GuardianHandOver::step(rt::Nanoseconds now, const Counts* counts) noexcept {
  const rt::Nanoseconds elapsed = now - entered_;
  watched_ = watched_ && counts != nullptr;
  if (watched_) look(now, *counts);
  if (phase_ == Phase::Over || (phase_ == Phase::Engaging && elapsed < hold_)) return;
  if (!watched_ || now - began_ >= hold_ + kLongest) return enter(Phase::Over, now);
  if (phase_ == Phase::Engaging) held_ = place_;
  if (isTooFar()) return enter(Phase::Over, now);
  if (phase_ == Phase::Engaging || (phase_ == Phase::Carrying && elapsed >= kAgain)) {
    from_ = place_;
    return enter(Phase::Transferring, now);
  }
  if (phase_ == Phase::Carrying) return;
  if (const int axis = slips(); axis != 0) {
    if (slipped_ == 0) slipped_ = axis;
    return enter(Phase::Carrying, now);
  }
  share_ = std::max(0.0, 1.0 - static_cast<double>(elapsed) / static_cast<double>(kTransfer));
  if (elapsed >= kTransfer + kWatch) enter(Phase::Over, now);
}

}  // namespace knee_robot::control
