#pragma once

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// The first sample at which the actuator has moved, 0 when it never does: before it its force at rest has what nobody
/// recorded in friction's memory.
int firstSettled(const EffectInput& input, int actuator);

}  // namespace knee_robot::tracing
