#include "one_path.h"

#include <algorithm>
#include <cmath>

#include "doubt.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSamePath_m = 0.002;  ///< rms over all actuators: repeats of one reference lie closer
constexpr double kMuchLeft = 3.0;      ///< noise floors that a model with the right force leaves hardly
constexpr int kPatchwork = 2;          ///< maps on one actuator that stand for one thing that none describes,
constexpr double kMostOfIt = 4.0;      ///< unless one explains so many times the squares of all others

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

bool actTogether(const Place& a, const Place& b) {
  return a.actuator == b.actuator || a.actuator < 0 || b.actuator < 0;
}

/// Maps that act where this one does.
int mapsBeside(const Search& s, const FoundEffect& one) {
  return static_cast<int>(std::count_if(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return e.hypothesis.place.candidate->isMap() && actTogether(one.hypothesis.place, e.hypothesis.place);
  }));
}

/// A map that did nearly all of what maps do there is no patch of others.
bool isMostOfIt(const Search& s, const FoundEffect& one) {
  const Place& place = one.hypothesis.place;
  const double own_N2 = std::pow(atPlace(place, one.explained_rms_N), 2);
  double all_N2 = 0.0;
  for (const FoundEffect& e : s.effects) {
    const Place& other = e.hypothesis.place;
    if (other.candidate->isMap() && actTogether(place, other)) all_N2 += std::pow(atPlace(place, e.explained_rms_N), 2);
  }
  return own_N2 > 0.0 && own_N2 >= kMostOfIt * (all_N2 - own_N2);
}

bool isUnsure(const FoundEffect& e) {
  return e.doubted || !e.indistinguishable_from.empty();
}

/// Empty, or why the path that was seen may be all that an effect describes.
std::string whyOfOnePath(const Search& s, const FoundEffect& e, double floors) {
  const Candidate& candidate = *e.hypothesis.place.candidate;
  // What pulls at the platform loads all legs: a map on one of them is part of it, however little that one leaves.
  const int actuator = e.hypothesis.place.actuator;
  const bool of_time = candidate.goesWithTime() && (candidate.isMap() || e.doubted);
  const bool of_all = of_time || actuator < 0 || (candidate.isMap() && candidate.positionOf(actuator) != actuator);
  const double anywhere = of_all ? (s.rms_N.array() / s.floor.rms_N.array()).maxCoeff() : floors;
  if (candidate.isForceField() && anywhere >= kMuchLeft)
    return "a force that depends on the pose alone, seen along one path, in a model that leaves " +
           shortNumber(anywhere, 2) + " times the noise floor: on another path the same pose may have another force";
  if (of_time && anywhere >= kMuchLeft)
    return "goes with time, seen along one path, in a model that leaves " + shortNumber(anywhere, 2) +
           " times the noise floor: at the same time another path is elsewhere";
  if (actuator < 0 && isUnsure(e) && (anywhere >= kMuchLeft || !s.floor.measured))
    return "acts on all actuators, may be something else, and was seen along one path, in a model that leaves " +
           shortNumber(anywhere, 2) + " times the " + (s.floor.measured ? "" : "estimated ") +
           "noise floor: on another path that may differ";
  if (e.maybeUnnamed() && e.indistinguishable_from.size() > 1 && floors >= kMuchLeft)
    return "may be something else, and was seen along one path, in a model that leaves " + shortNumber(floors, 2) +
           " times the noise floor there: on another path that may differ";
  const int maps = candidate.isMap() ? mapsBeside(s, e) : 0;
  if (s.floor.measured && maps >= kPatchwork && floors > kRightLeaves && !isMostOfIt(s, e))
    return "one of " + std::to_string(maps) + " maps, which together leave " + shortNumber(floors, 2) +
           " times the noise floor along one path: they fit the path, and what acts there is something else";
  return {};
}

}  // namespace

std::vector<int> pathsOf(const std::vector<identification::Observation>& recordings) {
  std::vector<int> path_of;
  int paths = 0;
  for (const identification::Observation& o : recordings) {
    const auto same = std::find_if(recordings.begin(), recordings.begin() + static_cast<std::ptrdiff_t>(path_of.size()),
                                   [&](const identification::Observation& known) { return followSamePath(known, o); });
    const std::size_t k = static_cast<std::size_t>(same - recordings.begin());
    path_of.push_back(k < path_of.size() ? path_of[k] : paths++);
  }
  return path_of;
}

bool isOnePathNotDescribed(const std::vector<std::string>& doubts,
                           const std::vector<identification::Observation>& recordings) {
  return !doubts.empty() && followOnePath(recordings);
}

void holdBackOnePath(Search& s, std::vector<std::string>& notes) {
  if (!s.data->recordings.front().motion.coupled || !followOnePath(s.data->recordings)) return;
  for (FoundEffect& e : s.effects) {
    if (!e.transfers) continue;
    const std::string why = whyOfOnePath(s, e, floorsLeft(s, e.hypothesis.place, s.rms_N));
    if (why.empty()) continue;
    e.transfers = false;
    notes.push_back(placeText(e.hypothesis.place) + ": " + why +
                    "; it is left out of predictions elsewhere. Train on a second path, too.");
  }
}

}  // namespace knee_robot::tracing
