#pragma once

#include <array>
#include <cstdint>

namespace knee_robot::simulation {

/// One step of the simulated robot, as it really was. Plain data for readers in other languages: no padding.
struct TruthRow {
  double monotonic_s;  ///< CLOCK_MONOTONIC at the end of the step
  double time_s;       ///< simulated
  std::array<double, 4> length_m;
  std::array<double, 4> pose;     ///< Xm, Zm (m), theta, psi (rad)
  std::array<double, 4> volts;    ///< at the converters during the step
  std::array<double, 4> force_N;  ///< of the motors
  std::uint32_t outputs;          ///< digital, bits 0 to 3
  std::uint32_t drives;           ///< bit a: drive a is on
  std::uint32_t holds;            ///< bit a: holding brake a is engaged
  std::uint32_t faults;           ///< InjectedFaults::generation
};
static_assert(sizeof(TruthRow) == 160, "readers rely on it");

}  // namespace knee_robot::simulation
