#include "knee_robot/control/lost_counts.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace knee_robot::control {
namespace {

constexpr rt::Nanoseconds kJust = 100'000'000;
constexpr std::int64_t kCounts = 5;  // open inputs dither by two

}  // namespace

LostCounts::Axes LostCounts::step(const SupervisorView& view, rt::Nanoseconds now) noexcept {
  if (marked_at_ == 0 || now - marked_at_ >= kJust) {
    mark_before_ = marked_at_ == 0 ? view.measured.counts : mark_;
    mark_ = view.measured.counts;
    marked_at_ = now;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const Fault judged = view.verdict.fault[i];
    const Fault tested = view.commands[i].fault;
    const bool frozen = judged == Fault::EncoderFrozen || tested == Fault::EncoderFrozen;
    if (frozen || (tested == Fault::AxisBlocked && !blocked_[i] && !othersCount(view, i))) doubted_.fill(true);
    blocked_[i] = tested == Fault::AxisBlocked;
  }
  Axes lost{};
  if (view.drivesAreOff()) std::swap(lost, doubted_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lost[i] = lost[i] || view.verdict.fault[i] == Fault::EncoderJump;
  return lost;
}

bool LostCounts::othersCount(const SupervisorView& view, std::size_t axis) const noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const std::int64_t now = view.measured.counts[i];
    if (i != axis && std::max(std::abs(now - mark_[i]), std::abs(now - mark_before_[i])) >= kCounts) return true;
  }
  return false;
}

}  // namespace knee_robot::control
