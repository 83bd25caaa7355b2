#pragma once

#include "knee_robot/tracing/given_model.h"
#include "search.h"

namespace knee_robot::tracing {

/// Puts the given model's effects into the search and fits them with the base to the new recordings. Those that do not
/// help on held-back blocks by more than a standard error are taken out again, the least needed one first. Effects that
/// belong to one recording of the file are left out. Maps of the file are added to `maps`, which must live as long as
/// the search.
GivenModel startFrom(const mechanism::Robot& robot, const StartModel& start, const CandidateList& named,
                     CandidateList& maps, Search& search);

}  // namespace knee_robot::tracing
