#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// What acts on the platform along all its coordinates at once and has no name (tissue, several dampers, a spinning
/// wheel): the generalized force as a matrix times the velocity, or times the way gone of late (springs that relax).
/// None on bench axes.
void addPlatformMatrices(const std::vector<EffectInput>& inputs, CandidateList& maps);

/// By what it depends on (Candidate::dependsOn); null when it is none of these.
std::unique_ptr<Candidate> platformMatrix(const std::string& depends_on);

}  // namespace knee_robot::tracing
