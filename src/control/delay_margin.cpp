#include "delay_margin.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "knee_robot/base/constants.h"

namespace knee_robot::control {
namespace {

constexpr double kSampling_s = 0.0015;

}  // namespace

double delayMargin(const PidGains& gains, double mass, double viscous) {
  const auto loop = [&](double w) {
    const std::complex<double> s(0.0, w);
    const std::complex<double> filtered = gains.derivative * s / (1.0 + s / (2.0 * kPi * gains.derivative_cutoff_hz));
    return (gains.proportional + gains.integral / s + filtered) / (mass * s * s + viscous * s) *
           std::exp(-kSampling_s * s);
  };
  constexpr double kStep = 1.002, kFastest = 1e4;
  double margin = 1e3;
  for (double w = 0.1; w < kFastest; w *= kStep) {
    if (!(std::abs(loop(w)) > 1.0 && std::abs(loop(w * kStep)) <= 1.0)) continue;
    double phase = kPi + std::arg(loop(w));
    if (phase > kPi) phase -= 2.0 * kPi;
    margin = std::min(margin, phase / w);
  }
  return margin;
}

}  // namespace knee_robot::control
