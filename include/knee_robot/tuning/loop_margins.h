#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "knee_robot/control/pid.h"

namespace knee_robot::tuning {

/// What a Driver's position loop drives: M q'' + b q' = F(t - delay). Coulomb friction only helps, and is left out.
struct AxisPlant {
  double mass_kg = 1.0;
  double viscous_N_s_per_m = 0.0;
  double delay_s = 0.0;  ///< from the command to the force, beyond the hold of one period
};

/// How far a closed position loop is from instability. Of an unstable loop only `stable` means anything.
struct LoopMargins {
  bool stable = false;
  double gain_up = 0.0;       ///< factor that all gains may grow by; infinity: any
  double gain_down = 0.0;     ///< factor that they may fall to; 0: any
  double phase_rad = 0.0;     ///< least over all crossings of |L| = 1
  double delay_s = 0.0;       ///< additional delay that is survived
  double sensitivity = 0.0;   ///< peak of |1 / (1 + L)|
  double crossover_hz = 0.0;  ///< highest frequency at which |L| = 1
};

/// Pid::update as a transfer function from error to force at `frequency_hz`, sampled every `period_s`; the derivative
/// acts on the error's derivative as far as the loop is concerned.
std::complex<double> pidResponse(const control::PidGains& gains, double period_s, double frequency_hz);
/// From the command, held for a period, to the sampled position (exact, with the delay's fraction of a period).
std::complex<double> plantResponse(const AxisPlant& plant, double period_s, double frequency_hz);
/// Frequencies from 0.05 Hz to half the sampling rate, evenly on a logarithmic scale: what margins are looked for at.
std::vector<double> marginFrequencies(double period_s);
/// Stability by the closed loop's eigenvalues, the rest by L = pidResponse * plantResponse.
LoopMargins loopMargins(const control::PidGains& gains, const AxisPlant& plant, double period_s);
/// Position after a step of the reference by 1, without its velocity (m per m); the loop as in loopMargins().
std::vector<double> stepResponse(const control::PidGains& gains, const AxisPlant& plant, double period_s, int samples);

}  // namespace knee_robot::tuning
