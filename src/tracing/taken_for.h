#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Effects that a wrong law near rest makes out of something simpler (Candidate::takenFor) give way to it, on all their
/// actuators at once, where it does not surely predict held-back blocks worse with the laws that are chosen beside it.
void preferSimpler(Search& search);

}  // namespace knee_robot::tracing
