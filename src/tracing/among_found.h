#pragma once

#include <algorithm>
#include <vector>

#include "knee_robot/tracing/trace_result.h"

namespace knee_robot::tracing {

/// Its place is taken.
inline bool isAmong(const std::vector<FoundEffect>& effects, const FoundEffect& one) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const FoundEffect& e) { return e.hypothesis.place == one.hypothesis.place; });
}

inline bool leads(const FoundEffect& e) {
  return e.hypothesis.place.candidate->leads();
}

/// Something leads on the actuator of `one`, which leads, already.
inline bool isKnownLead(const std::vector<FoundEffect>& effects, const FoundEffect& one) {
  return leads(one) && std::any_of(effects.begin(), effects.end(), [&](const FoundEffect& e) {
           return leads(e) && e.hypothesis.place.actuator == one.hypothesis.place.actuator;
         });
}

}  // namespace knee_robot::tracing
