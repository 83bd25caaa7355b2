#pragma once

#include "knee_robot/recording/recording.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::tracing {

/// A cycle of the reference that one recording contains more than once.
struct RepeatedCycle {
  int lag = 0;             ///< samples from one run to the next; 0: there is none
  std::vector<int> first;  ///< samples n whose reference is that of n + lag
};

/// Looks for the lag at which the longest moving part of the reference, at least one whole cycle of 2 s or more in
/// which some actuator's reference travels 5 mm, comes again within 0.1 mm (and half a sample of its motion). Of
/// equally good lags the shortest. None without reference columns.
RepeatedCycle findRepeatedCycle(const recording::Recording& recording, const recording::Signals& signals);

/// Samples of two recordings at which their references are the same.
struct RepeatedRun {
  int first_a = 0, first_b = 0;
  int samples = 0;  ///< 0: they do not repeat each other
};

/// Whether two recordings play one reference: compared in time, so that rows may be missing in either and one of them
/// may have waited longer before it began to move. The same within 0.1 mm rms (and half a sample of its motion) over
/// nine tenths of the longer one.
RepeatedRun findRepeatedRun(const recording::Recording& a, const recording::Signals& on_a,
                            const recording::Recording& b, const recording::Signals& on_b);

}  // namespace knee_robot::tracing
