#pragma once

#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {

/// Coulomb friction that builds up over 0.005 rad/s, and viscous friction, of a joint without motor: keys coulomb_N_m
/// and viscous_N_m_s_per_rad of an effect's entry.
class RubbingJoint {
 public:
  explicit RubbingJoint(StrictMap& entry);

  /// Torque (N m) at a rate (rad/s), against it.
  double resistance(double rate) const noexcept {
    return -coulomb_N_m_ * std::tanh(rate / kSlow_rad_per_s) - viscous_N_m_s_per_rad_ * rate;
  }

 private:
  static constexpr double kSlow_rad_per_s = 0.005;
  double coulomb_N_m_;
  double viscous_N_m_s_per_rad_;
};

}  // namespace knee_robot::simulation
