#pragma once

#include <vector>

#include "friction_fits.h"
#include "friction_shared.h"
#include "knee_robot/identification/friction_choice.h"

namespace knee_robot::identification {

/// Elements that are taken away from others, share -1: with them friction near rest is larger than beyond (stiction
/// that exceeds sliding friction, a hump along the path after a reversal). A tanh gives friction its peak at speeds
/// below its own; bristles along a path below their width. Speeds end where Stribeck friction begins as an effect.
void addTakenAway(const FrictionRange& range, std::vector<dynamics::FrictionElement>& all);

/// Finer steps around what a law takes away. What it is taken away from stays on the grid: finer steps of that would be
/// tried by all other families, too.
void addFinerPeak(const dynamics::FrictionLaw& found, std::vector<dynamics::FrictionElement>& all);

/// Best law with a peak of at most half the sliding friction: a pair, and with more elements of `mixing`.
std::vector<Sum> bestPeaks(const InWeights& squares, const std::vector<dynamics::FrictionElement>& elements,
                           const std::vector<int>& mixing);

}  // namespace knee_robot::identification
