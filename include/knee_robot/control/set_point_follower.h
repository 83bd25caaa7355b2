#pragma once

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// From set points to one axis' reference, free of jumps.
/// - Before the first segment that moves (SyncPhase::Idle) the reference stays where the axis was taken over.
/// - Within a segment it runs linearly from `from` to `to`.
/// - When the next segment is late, it comes to rest with constant deceleration within kCoast, in the direction of
///   travel; all four axes do so in the same time, so the platform stays near its path.
/// - Where a new run (or a late segment) begins away from the present reference, the difference fades out within
///   kBlend.
/// Within a run, a segment that does not continue the last one is a fault; so is a set point that did not come, which
/// is bridged by the same fading. Real-time safe.
class SetPointFollower {
 public:
  static constexpr rt::Nanoseconds kCoast = 100'000'000;
  static constexpr rt::Nanoseconds kBlend = 500'000'000;
  /// Segments in a row begin where the last one ended, up to rounding.
  static constexpr double kContinuity_m = 1e-9;

  /// Where the axis should be at an instant.
  struct Reference {
    double position = 0.0;  ///< m
    double velocity = 0.0;  ///< m/s
    bool at_rest = true;
  };

  SetPointFollower(int axis, double position_min, double position_max, double velocity_max, int missing_allowed = 0);

  /// Holds at `position` from now on; what came before is forgotten.
  void takeOver(double position, rt::Nanoseconds now) noexcept;
  /// A new set point. None, NotANumber, SetPointJump (the reference goes on as if it had not come), or SetPointStale:
  /// more set points before it than `missing_allowed` did not come, but this one is followed.
  Fault accept(const SetPoint& set_point, rt::Nanoseconds now) noexcept;
  Reference at(rt::Nanoseconds now) const noexcept;
  /// Nothing new for more than `periods` set point periods.
  bool isStale(rt::Nanoseconds now, int periods) const noexcept;

 private:
  struct Segment {
    rt::Nanoseconds start = 0, duration = 0;
    double from = 0.0, to = 0.0, from_velocity = 0.0, to_velocity = 0.0;
  };
  Reference onSegment(const Segment& segment, rt::Nanoseconds now) const noexcept;
  Fault check(const Segment& next, const SetPoint& set_point) const noexcept;

  std::size_t axis_;
  double min_, max_, velocity_max_;
  int missing_allowed_;
  bool following_ = false;
  double held_ = 0.0;
  Segment segment_;
  std::uint64_t sequence_ = 0;
  std::uint32_t run_ = 0;
  double offset_ = 0.0;
  rt::Nanoseconds offset_start_ = 0;
  rt::Nanoseconds heard_ = 0;  // start of the newest set point
  rt::Nanoseconds expected_period_ = 10'000'000;
};

}  // namespace knee_robot::control
