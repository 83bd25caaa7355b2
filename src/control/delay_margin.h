#pragma once

#include "knee_robot/control/pid.h"

namespace knee_robot::control {

/// How much later than now a drive may act before the position loop of its axis becomes unstable, s: phase margin over
/// crossover frequency of the loop P + I/s + D s (with its low-pass) on mass * s^2 + viscous * s, less 1.5 periods of 1
/// ms for sampling and hold. Friction that sticks is left out: it helps. `mass` (kg): of the axis while the other axes
/// hold, rotor included. Negative: unstable already.
double delayMargin(const PidGains& gains, double mass, double viscous);

}  // namespace knee_robot::control
