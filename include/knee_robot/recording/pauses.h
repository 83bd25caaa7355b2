#pragma once

#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// Closes pauses: times after an interval without rows of more than `longest_s` are moved up until it lasts so long. A
/// uniform grid would otherwise fill hours in which nothing is known. Returns the seconds that were taken out, and says
/// so in the recording's notes; what depends on time (a drive that warms up) misses them.
double closePauses(Recording& recording, double longest_s);

}  // namespace knee_robot::recording
