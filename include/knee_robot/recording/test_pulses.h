#pragma once

#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// Bridges the forces of rows in which the controller asked an encoder whether it counts, and of those in which the
/// robot comes to rest from it: no model predicts how far friction has built up then, and a low-pass would
/// spread the pulse. Recording::test_pulse is not 0 in all of them afterwards, and resample() does not know their
/// samples. A note says how many. Nothing happens when rows do not tell, or when all of them are such.
void bridgeTestPulses(Recording& recording);

}  // namespace knee_robot::recording
