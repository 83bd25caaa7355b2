#include "ripple_periods.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knee_robot::tracing {
namespace {

constexpr double kTurnsApart = 2.0;   ///< nearer, the one may be a side lobe of the other, whose size changes
constexpr double kOrderWithin = 0.3;  ///< turns over the way within which a period is an order of the other,
constexpr double kOrdersApart = 1.0;  ///< and no side lobe from here on

/// The way (m) of an actuator over all recordings that are searched.
double wayOf(const Search& s, int actuator) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const EffectInput& input : s.data->inputs) {
    const auto q = input.signals().position_m.col(actuator);
    low = std::min(low, q.minCoeff());
    high = std::max(high, q.maxCoeff());
  }
  return high - low;
}

/// Turns along `way_m` by which two periods must differ to be told apart.
double turnsNeeded(double a_m, double b_m, double way_m) {
  const double longer = std::max(a_m, b_m), shorter = std::min(a_m, b_m), order = std::round(longer / shorter);
  return order > 1.0 && std::abs(1.0 / shorter - order / longer) * way_m < kOrderWithin ? kOrdersApart : kTurnsApart;
}

bool isAnother(const Place& place, const Place& other) {
  return place.candidate == other.candidate && place.actuator == other.actuator && place.order != other.order;
}

}  // namespace

bool periodCoincides(const Search& s, const Hypothesis& ripple) {
  if (!ripple.place.candidate->periodic()) return false;
  return std::any_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    if (!isAnother(ripple.place, e.hypothesis.place)) return false;  // it may have no shape at all
    const double own = ripple.shape[0], other = e.hypothesis.shape[0], way = wayOf(s, ripple.place.actuator);
    return std::abs(1.0 / other - 1.0 / own) * way < turnsNeeded(own, other, way);
  });
}

std::pair<double, double> roomOfPeriod(const Search& s, std::size_t effect) {
  const Hypothesis& own = s.effects[effect].hypothesis;
  const double way = wayOf(s, own.place.actuator);
  double fewest = 0.0, most = std::numeric_limits<double>::infinity();  // turns per metre
  if (!own.place.candidate->periodic()) return {-most, most};           // no period: an anchor may lie on either side
  for (const FoundEffect& e : s.effects) {
    if (!isAnother(own.place, e.hypothesis.place)) continue;
    const double mine = 1.0 / own.shape[0], theirs = 1.0 / e.hypothesis.shape[0];
    const double gap = std::abs(mine - theirs) - turnsNeeded(own.shape[0], e.hypothesis.shape[0], way) / way;
    const double room = 0.5 * std::max(0.0, gap);
    (theirs < mine ? fewest : most) = theirs < mine ? std::max(fewest, mine - room) : std::min(most, mine + room);
  }
  return {1.0 / most, fewest > 0.0 ? 1.0 / fewest : std::numeric_limits<double>::infinity()};
}

}  // namespace knee_robot::tracing
