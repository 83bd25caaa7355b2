#pragma once

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::simulation {

/// What repeats with a screw's angle: sin(2 pi length / period_m + phase_deg), of an entry's keys.
class Ripple {
 public:
  explicit Ripple(StrictMap& entry)
      : wave_number_(kTwoPi / entry.number("period_m", 1e-4, 1.0)),
        phase_(entry.numberOr("phase_deg", 0.0, -360.0, 360.0) / kDegrees) {}
  double at(double length_m) const noexcept { return std::sin(wave_number_ * length_m + phase_); }

 private:
  double wave_number_, phase_;
};

}  // namespace knee_robot::simulation
