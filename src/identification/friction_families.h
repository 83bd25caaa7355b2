#pragma once

#include <array>
#include <vector>

#include "friction_fits.h"
#include "friction_shared.h"
#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::identification {

/// Parts that a law may be made of, on grids of the range; all stops stand first.
std::vector<dynamics::FrictionElement> elementsToTry(const FrictionRange& range);

/// Finer steps around the shapes that an earlier choice found for single elements.
void addFinerSteps(const FrictionChoice& around, double narrowest_m, std::vector<dynamics::FrictionElement>& all);

/// Shape parameters of every family: one stop, tanh, Dahl's bristles, a tanh that lags, any bristles, all stops together (Maxwell slip),
/// pairs, sums, all speeds of tanh together; one rare element, a pair and a sum with one.
inline constexpr std::array<int, 12> kFamilyNumbers = {1, 1, 1, 2, 3, 6, 4, 8, 8, 2, 4, 8};
inline constexpr long kUsualFamilies = 9;

/// A stop behind a clearance, or one that relaxes: what bends as they do may be a controller that settles, too, so that
/// they have to be surely better than all others.
constexpr bool isRare(const dynamics::FrictionElement& e) {
  return e.gap_m > 0.0 || e.relaxation_s > 0.0;
}

/// Many elements at once, whose shares come near to any law.
constexpr bool isSpectrum(long family) {
  return family == 5 || family == 8;
}

/// The best law of every family, simplest first; without elements where there is none.
std::vector<Sum> bestOfFamilies(const InWeights& squares, const std::vector<dynamics::FrictionElement>& elements,
                                const FrictionRange& range);

}  // namespace knee_robot::identification
