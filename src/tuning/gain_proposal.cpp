#include "knee_robot/tuning/gain_proposal.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::tuning {
namespace {

constexpr double kSlowest_hz = 0.5;
constexpr double kStep = 1.04;  // from one crossover to the next one that is tried

control::PidGains gainsAt(double crossover_hz, double mass) {
  const double w = kTwoPi * crossover_hz;
  control::PidGains gains;
  gains.derivative = mass * w;
  gains.proportional = gains.derivative * w / 3.0;
  gains.integral = gains.proportional * w / 20.0;
  gains.derivative_cutoff_hz = std::clamp(5.0 * crossover_hz, 20.0, 200.0);
  return gains;
}

/// Three digits: nobody enters more, and the margins are those of what is entered.
double rounded(double value) {
  if (!(value > 0.0)) return value;
  const double scale = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::round(value / scale) * scale;
}

control::PidGains rounded(const control::PidGains& gains) {
  return {rounded(gains.proportional), rounded(gains.integral), rounded(gains.derivative),
          rounded(gains.derivative_cutoff_hz)};
}

}  // namespace

std::vector<AxisPlant> PlantRange::corners() const {
  std::vector<AxisPlant> all;
  for (const double mass : {low.mass_kg, high.mass_kg}) {
    for (const double viscous : {low.viscous_N_s_per_m, high.viscous_N_s_per_m}) {
      for (const double delay : {low.delay_s, high.delay_s})
        all.push_back({mass, viscous, delay});
    }
  }
  return all;
}

bool MarginDemand::isMetBy(const LoopMargins& m) const {
  return m.stable && m.sensitivity <= sensitivity && m.gain_up >= gain && m.gain_down <= 1.0 / gain &&
         m.phase_rad >= phase_rad;
}

LoopMargins worstMargins(const control::PidGains& gains, const PlantRange& range, double period_s) {
  std::optional<LoopMargins> worst;
  for (const AxisPlant& plant : range.corners()) {
    const LoopMargins one = loopMargins(gains, plant, period_s);
    if (!worst) {
      worst = one;
      continue;
    }
    worst->stable = worst->stable && one.stable;
    worst->gain_up = std::min(worst->gain_up, one.gain_up);
    worst->gain_down = std::max(worst->gain_down, one.gain_down);
    worst->phase_rad = std::min(worst->phase_rad, one.phase_rad);
    worst->delay_s = std::min(worst->delay_s, one.delay_s);
    worst->sensitivity = std::max(worst->sensitivity, one.sensitivity);
    worst->crossover_hz = std::max(worst->crossover_hz, one.crossover_hz);
  }
  return *worst;
}

double kickOfOneCount(const control::PidGains& gains, double period_s, double count_m) {
  const double share = period_s / (1.0 / (kTwoPi * gains.derivative_cutoff_hz) + period_s);
  return count_m * (gains.proportional + gains.derivative * share / period_s);
}

std::optional<control::PidGains> proposeGains(const PlantRange& range, double period_s, const MarginDemand& demand,
                                              const GainBounds& bounds) {
  const std::vector<AxisPlant> corners = range.corners();
  const double mass = std::sqrt(range.low.mass_kg * range.high.mass_kg);
  for (double crossover = bounds.highest_crossover_hz; crossover >= kSlowest_hz; crossover /= kStep) {
    const control::PidGains gains = rounded(gainsAt(crossover, mass));
    if (kickOfOneCount(gains, period_s, bounds.count_m) > bounds.largest_kick_N) continue;
    const auto keeps = [&](const AxisPlant& plant) {
      const LoopMargins margins = loopMargins(gains, plant, period_s);
      return margins.crossover_hz <= bounds.highest_crossover_hz && demand.isMetBy(margins);
    };
    if (std::all_of(corners.begin(), corners.end(), keeps)) return gains;
  }
  return std::nullopt;
}

}  // namespace knee_robot::tuning
