#pragma once

#include <string>

#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// Why a recording's reference is not what its axes follow ("reference 1 ..."): it stands while the axis moves, goes
/// another way (another unit, another axis), or lies far away. Empty: it may be followed, or there is none.
std::string whyNotFollowed(const Recording& recording);

}  // namespace knee_robot::recording
