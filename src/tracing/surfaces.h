#pragma once

#include "hats.h"

namespace knee_robot::tracing {

/// Dry friction as a smooth surface over the actuator's speed and its position, or over its speed and what it carries:
/// lubrication that depends on the load, screws that whirl at a speed that depends on their length. Looked for where all
/// else has left something: with so many coefficients it comes near to most friction.
void addSurfaces(const std::vector<EffectInput>& inputs, CandidateList& surfaces);

/// By what it depends on (Candidate::dependsOn); null when it is none of these, or has another number of knots.
std::unique_ptr<Candidate> surface(const std::string& depends_on, int actuator, const std::vector<double>& knots);

}  // namespace knee_robot::tracing
