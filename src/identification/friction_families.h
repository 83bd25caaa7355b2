#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "friction_fits.h"
#include "friction_shared.h"
#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::identification {

/// Parts that a law may be made of, on grids of the range; all stops stand first.
std::vector<dynamics::FrictionElement> elementsToTry(const FrictionRange& range);

/// Finer steps around the shapes that an earlier choice found for single elements.
void addFinerSteps(const FrictionChoice& around, double narrowest_m, std::vector<dynamics::FrictionElement>& all);

/// May stand beside others in a law. A power of the velocity beside its tanh rises late and steeply, as Stribeck friction
/// does: alone or not at all. So does a stop behind a clearance, which would mend the shape of any other a little; a
/// ramp's corner; and the other shapes, which sums of tanh can be.
bool mixes(const dynamics::FrictionElement& e);

/// Puts those that mix first, the others after them, each in the order that they have; `laws` are of the same elements
/// as before. Returns how many mix.
int mixingFirst(std::vector<dynamics::FrictionElement>& elements, std::vector<Sum>& laws);

/// Shape parameters of every family: one stop, tanh, Dahl's bristles, three other smooth laws, any bristles, all stops together (Maxwell slip),
/// pairs, sums, all speeds of tanh together; a ramp; a tanh that lags; one rare element, a pair and a sum with one; a pair and a
/// sum with a peak.
inline constexpr std::array<int, 18> kFamilyNumbers = {1, 1, 1, 1, 1, 1, 3, 6, 4, 8, 8, 1, 2, 2, 4, 8, 4, 8};
inline constexpr std::array<int, 4> kOfVelocity = {1, 3, 4, 5};          ///< families of one smooth law
inline constexpr long kTanh = 1, kOtherSmooth = 3, kOtherSmoothEnd = 6;  ///< these have to be surely better than tanh
/// Where a group of families ends: usual ones, and those that have to be surely better than all before.
inline constexpr std::array<long, 5> kGroupEnds = {11, 12, 13, 16, 18};
inline constexpr std::size_t kGroupOfRamp = 1;
inline constexpr std::size_t kGroupOfRest = 3;  ///< stops behind a clearance and those that relax

/// A stop behind a clearance, one that relaxes, a tanh that lags, or what is taken away from others (a peak near rest):
/// what bends as they do may be a controller that settles, too, so that they have to be surely better than all others.
constexpr bool isRare(const dynamics::FrictionElement& e) {
  return e.gap_m > 0.0 || e.relaxation_s > 0.0 || e.lag_s > 0.0 || e.share < 0.0;
}

/// Of the squares: an element that lowers them by less is not added to a sum.
inline constexpr double kWorthAdding = 0.01;

/// Value k of `count` from `first` to `last`, in equal ratios.
inline double geometric(double first, double last, int k, int count) {
  return first * std::pow(last / first, static_cast<double>(k) / (count - 1));
}

inline constexpr long kAllStops = 7, kAllSpeeds = 10;
/// Many elements at once, whose shares come near to any law.
constexpr bool isSpectrum(long family) {
  return family == kAllStops || family == kAllSpeeds;
}

/// The best law of every family, simplest first; without elements where there is none.
std::vector<Sum> bestOfFamilies(const InWeights& squares, const std::vector<dynamics::FrictionElement>& elements,
                                const FrictionRange& range);

}  // namespace knee_robot::identification
