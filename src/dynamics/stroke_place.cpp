#include "knee_robot/dynamics/stroke_place.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::dynamics {

StrokePlace::StrokePlace(double center_m, double width_m, double from_m, double to_m) noexcept
    : center_m_(center_m), width_m_(width_m), from_m_(from_m), to_m_(std::max(from_m, to_m)) {
  const double range = (to_m_ - from_m_) / width_m_;
  const double low = (from_m_ - center_m_) / width_m_, high = (to_m_ - center_m_) / width_m_;
  mean_ = range > 1e-6 ? 0.5 * std::sqrt(kPi) * (std::erf(high) - std::erf(low)) / range : within(from_m_);
}

double StrokePlace::within(double position_m) const noexcept {
  const double away = (position_m - center_m_) / width_m_;
  return std::exp(-away * away);
}

bool StrokePlace::endsWithin(double end_m) const noexcept {
  return from_m_ < center_m_ && center_m_ < to_m_ && within(end_m) < mean_;
}

double StrokePlace::at(double position_m) const noexcept {
  const double seen_m = std::clamp(position_m, from_m_, to_m_);
  if (seen_m == position_m || endsWithin(seen_m)) return within(position_m);
  const double beyond = (position_m - seen_m) / width_m_;
  return mean_ + (within(seen_m) - mean_) * std::exp(-beyond * beyond);
}

}  // namespace knee_robot::dynamics
