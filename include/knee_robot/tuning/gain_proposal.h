#pragma once

#include <optional>
#include <vector>

#include "knee_robot/tuning/loop_margins.h"

namespace knee_robot::tuning {

/// What is known of an axis: the plant lies somewhere in here, over poses and within the measurement's uncertainty.
struct PlantRange {
  AxisPlant low;   ///< smallest mass, viscous friction and delay
  AxisPlant high;  ///< largest
  /// All combinations: what margins have to hold for.
  std::vector<AxisPlant> corners() const;
};

/// What a proposal has to keep for every plant of the range.
struct MarginDemand {
  double sensitivity = 1.7;         ///< largest peak of |1 / (1 + L)|
  double gain = 2.5;                ///< gains may grow by this factor, and fall to its inverse
  double phase_rad = 0.6981317008;  ///< 40 deg
  bool isMetBy(const LoopMargins& margins) const;
};

/// What else bounds the gains.
struct GainBounds {
  double highest_crossover_hz = 50.0;  ///< nothing is known of the axis beyond
  double count_m = 1e-5;               ///< the encoder's step ...
  double largest_kick_N = 20.0;        ///< ... may change the force by so much
};

/// The worst of every margin over the corners of a range.
LoopMargins worstMargins(const control::PidGains& gains, const PlantRange& range, double period_s);

/// Change of force when the encoder counts once, N.
double kickOfOneCount(const control::PidGains& gains, double period_s, double count_m);

/// Gains of one shape, as fast as demand and bounds allow: D = m w, P = D w / 3, I = P w / 20, with m the geometric
/// mean of the range's masses, w the crossover (rad/s), and the velocity's low-pass at five times it (20 to 200 Hz).
/// None when not even a crossover of 0.5 Hz keeps them.
std::optional<control::PidGains> proposeGains(const PlantRange& range, double period_s, const MarginDemand& demand,
                                              const GainBounds& bounds);

}  // namespace knee_robot::tuning
