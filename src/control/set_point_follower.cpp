#include "knee_robot/control/set_point_follower.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {

SetPointFollower::SetPointFollower(int axis, double position_min, double position_max, double velocity_max,
                                   int missing_allowed)
    : axis_(static_cast<std::size_t>(axis)),
      min_(position_min),
      max_(position_max),
      velocity_max_(velocity_max),
      missing_allowed_(missing_allowed) {}

void SetPointFollower::takeOver(double position, rt::Nanoseconds now) noexcept {
  following_ = false;
  held_ = position;
  offset_ = 0.0;
  run_ = 0;
  sequence_ = 0;
  heard_ = now;
}

Fault SetPointFollower::check(const Segment& next, const SetPoint& set_point) const noexcept {
  const bool finite = std::isfinite(next.from) && std::isfinite(next.to) && std::isfinite(next.from_velocity) &&
                      std::isfinite(next.to_velocity);
  if (!finite) return Fault::NotANumber;
  const double period = rt::toSeconds(next.duration);
  // What the reference check has let through is at most velocity_max; the margin is for rounding.
  const double reach = 1.001 * velocity_max_ * period + kContinuity_m;
  if (period <= 0.0 || std::abs(next.to - next.from) > reach) return Fault::SetPointJump;
  if (following_ && set_point.run == run_) {
    const auto lost = static_cast<double>(set_point.sequence - sequence_ - 1);  // set points that this axis did not see
    if (std::abs(next.from - segment_.to) > kContinuity_m + lost * reach) return Fault::SetPointJump;
  }
  return Fault::None;
}

Fault SetPointFollower::accept(const SetPoint& set_point, rt::Nanoseconds now) noexcept {
  const Segment next{set_point.start,
                     set_point.duration,
                     set_point.from_m[axis_],
                     set_point.to_m[axis_],
                     set_point.from_velocity[axis_],
                     set_point.to_velocity[axis_]};
  const bool same_run = following_ && set_point.phase != SyncPhase::Idle && set_point.run == run_;
  const std::uint64_t missing = same_run ? set_point.sequence - sequence_ - 1 : 0;
  if (set_point.phase != SyncPhase::Idle) {
    const Fault fault = check(next, set_point);
    if (fault != Fault::None) return fault;
    const bool new_run = !following_ || set_point.run != run_;
    const bool late = following_ && now > segment_.start + segment_.duration;
    // At rest on a path a late set point leaves nothing to blend; begun anew with each, what is left would never end.
    const bool goes_on = !new_run && onSegment(segment_, now).position == onSegment(next, now).position;
    if ((new_run || late || missing > 0) && !goes_on) {
      offset_ = at(now).position - onSegment(next, now).position;
      offset_start_ = now;
    }
    segment_ = next;
    following_ = true;
    run_ = set_point.run;
  }
  sequence_ = set_point.sequence;
  heard_ = set_point.start;
  if (set_point.duration > 0) expected_period_ = set_point.duration;
  return missing > static_cast<std::uint64_t>(missing_allowed_) ? Fault::SetPointStale : Fault::None;
}

SetPointFollower::Reference SetPointFollower::onSegment(const Segment& segment, rt::Nanoseconds now) const noexcept {
  const double share = std::max(0.0, static_cast<double>(now - segment.start) / static_cast<double>(segment.duration));
  Reference reference;
  if (share <= 1.0) {
    reference.position = segment.from + share * (segment.to - segment.from);
    reference.velocity = segment.from_velocity + share * (segment.to_velocity - segment.from_velocity);
    reference.at_rest = segment.from == segment.to;
    return reference;
  }
  const double speed = (segment.to - segment.from) / rt::toSeconds(segment.duration);
  const rt::Nanoseconds beyond = now - segment.start - segment.duration;
  const double x = std::min(1.0, static_cast<double>(beyond) / static_cast<double>(kCoast));
  reference.position = std::clamp(segment.to + speed * rt::toSeconds(kCoast) * (x - 0.5 * x * x), min_, max_);
  reference.velocity = speed * (1.0 - x);
  reference.at_rest = x >= 1.0 || speed == 0.0;
  return reference;
}

SetPointFollower::Reference SetPointFollower::at(rt::Nanoseconds now) const noexcept {
  if (!following_) return {held_, 0.0, true};
  Reference reference = onSegment(segment_, now);
  const double x = static_cast<double>(now - offset_start_) / static_cast<double>(kBlend);
  if (offset_ != 0.0 && x < 1.0) {
    const double clipped = std::max(0.0, x);
    reference.position += offset_ * (1.0 - clipped * clipped * (3.0 - 2.0 * clipped));  // smooth step
    reference.velocity -= offset_ * 6.0 * clipped * (1.0 - clipped) / rt::toSeconds(kBlend);
    reference.at_rest = false;
  }
  return reference;
}

bool SetPointFollower::isStale(rt::Nanoseconds now, int periods) const noexcept {
  return now - heard_ > periods * expected_period_;
}

}  // namespace knee_robot::control
