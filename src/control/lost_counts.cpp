#include "lost_counts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace knee_robot::control {
namespace {

constexpr rt::Nanoseconds kJust = 100'000'000;
constexpr std::int64_t kCounts = 5;  // open inputs dither by two

}  // namespace

LostCounts::Axes LostCounts::step(const SupervisorView& view, bool faulted, rt::Nanoseconds now) noexcept {
  if (marked_at_ == 0 || now - marked_at_ >= kJust) {
    mark_before_ = marked_at_ == 0 ? view.measured.counts : mark_;
    mark_ = view.measured.counts;
    marked_at_ = now;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const Fault judged = view.verdict.fault[i];
    const Fault tested = view.commands[i].fault;
    const bool frozen = judged == Fault::EncoderFrozen || tested == Fault::EncoderFrozen;
    const bool blocked = tested == Fault::AxisBlocked;
    if (frozen || (blocked && !blocked_[i] && !othersCount(view, i))) doubted_.fill(true);
    blocked_[i] = blocked;
    watch(view, i);
    doubted_[i] = doubted_[i] || blocked || (faulted && unseen_[i]);
  }
  Axes lost{};
  if (view.drivesAreOff()) std::swap(lost, doubted_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lost[i] = lost[i] || view.verdict.fault[i] == Fault::EncoderJump;
  return lost;
}

/// A loop that was given up follows nothing any more, and an axis behind engaged brakes need not count: what was seen
/// before stands.
void LostCounts::watch(const SupervisorView& view, std::size_t axis) noexcept {
  const AxisCommand& command = view.commands[axis];
  const bool counts = std::abs(view.measured.counts[axis] - seen_counts_[axis]) > kCounts;
  const bool carries = view.written.level == DriveLevel::Released;
  const SafeStopPhase phase = view.written.safe_stop;
  const hardware::BusFailure& bus = view.measured.bus_failure;
  // Feedback that does not arrive is no missed count: the drive goes on counting.
  const bool old = bus.fault != hardware::BusFault::None || (bus.silent >> axis & 1u) != 0;
  if (!old && carries && !(command.active && (phase == SafeStopPhase::Idle || slowsDown(phase)))) return;
  if (!carries || counts || old) {
    seen_counts_[axis] = view.measured.counts[axis];
    seen_reference_m_[axis] = command.reference_m;
    unseen_[axis] = false;
  } else if (std::abs(command.reference_m - seen_reference_m_[axis]) >= kUnseen_m) {
    unseen_[axis] = true;
  }
}

bool LostCounts::othersCount(const SupervisorView& view, std::size_t axis) const noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const std::int64_t now = view.measured.counts[i];
    if (i != axis && std::max(std::abs(now - mark_[i]), std::abs(now - mark_before_[i])) >= kCounts) return true;
  }
  return false;
}

}  // namespace knee_robot::control
