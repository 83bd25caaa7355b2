#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "search.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSamePath_m = 0.002;  ///< rms over all actuators: repeats of one reference lie closer
constexpr double kMuchLeft = 3.0;      ///< noise floors that a model with the right force leaves hardly

/// Positions of two recordings at the same times from their beginnings.
bool followSamePath(const identification::Observation& one, const identification::Observation& other) {
  const double period_s = one.signals.period_s;
  const int count = std::min(one.samples(), static_cast<int>(other.samples() * other.signals.period_s / period_s));
  if (count == 0) return false;
  double square = 0.0;
  for (int n = 0; n < count; ++n) {
    const int m = std::min(other.samples() - 1, static_cast<int>(std::lround(n * period_s / other.signals.period_s)));
    square += (one.signals.position_m.row(n) - other.signals.position_m.row(m)).squaredNorm();
  }
  return std::sqrt(square / count) < kSamePath_m;
}

bool followOnePath(const std::vector<identification::Observation>& recordings) {
  return std::all_of(recordings.begin() + 1, recordings.end(),
                     [&](const identification::Observation& o) { return followSamePath(recordings.front(), o); });
}

}  // namespace

void holdBackOnePath(Search& s, std::vector<std::string>& notes) {
  if (!s.data->recordings.front().motion.coupled || !followOnePath(s.data->recordings)) return;
  for (FoundEffect& e : s.effects) {
    if (!e.transfers || !e.hypothesis.place.candidate->isForceField()) continue;
    const double floors = floorsLeft(s, e.hypothesis.place, s.rms_N);
    if (floors < kMuchLeft) continue;
    e.transfers = false;
    notes.push_back(placeText(e.hypothesis.place) +
                    ": a force that depends on the pose alone, seen along one path, in a model that leaves " +
                    shortNumber(floors, 2) +
                    " times the noise floor: on another path the same pose may have another force; it is left out of "
                    "predictions elsewhere. Train on a second path, too.");
  }
}

}  // namespace knee_robot::tracing
