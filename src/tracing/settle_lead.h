#pragma once

#include "search.h"

namespace knee_robot::tracing {

/// Dead time and lag of a drive are the same to first order: decides for all actuators together by what they are beyond
/// it, on held-back blocks; the rival is named where they cannot be told apart.
void settleLeads(Search& search);

/// Takes out what leads where that helps near rest only: where an axis sticks, the force that builds up before it breaks
/// away runs ahead of the motion, too.
void dropLeadsOfRest(Search& search);

}  // namespace knee_robot::tracing
