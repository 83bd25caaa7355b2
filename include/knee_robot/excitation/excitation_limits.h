#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knee_robot/excitation/fourier_series.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::excitation {

/// Friction that an expected force counts with: a robot file has none.
struct ExpectedFriction {
  double viscous_N_s_per_m = 150.0;
  double coulomb_N = 15.0;
};

/// The closest approach of one limit along a motion.
struct LimitUsed {
  std::string name;     ///< "velocity of actuator 2"
  double value = 0.0;   ///< SI (angles rad), where it is closest
  double limit = 0.0;   ///< SI
  double share = 0.0;   ///< 0 far away, 1 at the limit; lengths count from the middle of the range
  double time_s = 0.0;  ///< of that; 0 for what belongs to the whole motion (rms force)
};

/// Every limit of `robot` that the series comes to, looked at every `step_s`: lengths, velocities, accelerations, joint
/// angles, singularity margin; with a URDF also the peak and rms of the force that the links' inertia, gravity and the
/// expected friction need, against force_max_N (or the voltage) and force_continuous_N. One entry per quantity and
/// actuator. Nothing when the mechanism cannot follow the series.
std::optional<std::vector<LimitUsed>> limitsUsed(const mechanism::Robot& robot, const FourierSeries& series,
                                                 const ExpectedFriction& friction, double step_s = 0.001);

}  // namespace knee_robot::excitation
