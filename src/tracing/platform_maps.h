#pragma once

#include "hats.h"

namespace knee_robot::tracing {

/// What acts on the platform itself and has no name (a limb, a magnet, a seal, a cable chain): the generalized force
/// along one coordinate of the pose as a smooth function of that coordinate, of its rate, or of the rate in proportion
/// to such a function. None on bench axes.
void addPlatformMaps(const std::vector<EffectInput>& inputs, CandidateList& maps);

/// By what it depends on (Candidate::dependsOn); null when it is none of these.
std::unique_ptr<Candidate> platformMap(const std::string& depends_on, const std::vector<double>& knots);

}  // namespace knee_robot::tracing
