#pragma once

namespace knee_robot::control {

/// What a component takes for the time since its last cycle at most: a pause of the machine winds nothing up.
constexpr double kLongestStep_s = 0.005;

}  // namespace knee_robot::control
