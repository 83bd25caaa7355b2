#pragma once

#include <nlohmann/json.hpp>

#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::nodes {

/// What check_reference says, for programs: points, duration_s, margins (quantity, value, limit, unit, left, line,
/// actuator), violation (sentence or null) and path (time_s, lengths in m and pose in m and rad of at most 300 points;
/// pose empty where there is none; path null when the reference cannot be followed). SI.
nlohmann::json referenceJson(const trajectory::Reference& reference, const trajectory::ReferenceCheck& check);

}  // namespace knee_robot::nodes
