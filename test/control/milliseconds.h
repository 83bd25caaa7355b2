#pragma once

#include "knee_robot/rt/cycle.h"

namespace knee_robot::control {

inline constexpr rt::Nanoseconds kMs = 1'000'000;

}  // namespace knee_robot::control
