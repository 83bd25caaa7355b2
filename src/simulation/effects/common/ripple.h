#pragma once

#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::simulation {

/// What repeats with a screw's angle: sin(2 pi length / period_m + phase_deg), of an entry's keys.
class Ripple {
 public:
  explicit Ripple(StrictMap& entry);
  double at(double length_m) const noexcept;

 private:
  double wave_number_, phase_;
};

}  // namespace knee_robot::simulation
