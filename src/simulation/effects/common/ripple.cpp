#include "ripple.h"

#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::simulation {

Ripple::Ripple(StrictMap& entry)
    : wave_number_(kTwoPi / entry.number("period_m", 1e-4, 1.0)),
      phase_(entry.numberOr("phase_deg", 0.0, -360.0, 360.0) / kDegrees) {}

double Ripple::at(double length_m) const noexcept {
  return std::sin(wave_number_ * length_m + phase_);
}

}  // namespace knee_robot::simulation
