#include "knee_robot/recording/pauses.h"

#include "knee_robot/base/numbers.h"

namespace knee_robot::recording {

double closePauses(Recording& r, double longest_s) {
  double closed_s = 0.0, before = r.time_s.empty() ? 0.0 : r.time_s.front();
  for (double& t : r.time_s) {
    if (t - before > longest_s) closed_s += t - before - longest_s;
    before = t;
    t -= closed_s;
  }
  if (closed_s > 0.0)
    r.notes.push_back("Pauses without rows of together " + shortNumber(closed_s, 3) +
                      " s were closed: nothing is known of them.");
  return closed_s;
}

}  // namespace knee_robot::recording
