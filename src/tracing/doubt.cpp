// A name is only as good as what the model with it leaves.

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "search.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

/// Noise floors that models with the right effects leave while axes move, at most 2.1 on 19 machines of two independent
/// simulators; those with names that stand for something else left 2.6 to 11 (docs/results/foreign_machines.md). All of
/// them had repeats. A floor that was estimated says too little to take a name away: where axes stick, a healthy robot
/// leaves ten of them.
constexpr double kRightLeaves = 2.2;
constexpr double kEven = 0.5;
/// Most for a name that harms at held-back positions: none of 48 right ones on 44 machines did.
constexpr double kHarmful = 0.45;
/// Share of held-back stretches that must gain by what a name says: 30 right ones on 9 machines gained in 0.92 or more,
/// names for something that has none in 0.67.
constexpr double kMostStretches = 0.7;

/// Root mean square of what the model leaves while the axis moves.
Eigen::VectorXd movingRms(const Search& s) {
  const Stack& stack = s.data->stack;
  Eigen::VectorXd square = Eigen::VectorXd::Zero(stack.axes), count = square;
  for (int i = 0; i < stack.axes; ++i) {
    for (Eigen::Index n = 0; n < stack.size(); ++n) {
      const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
      if (!s.data->recordings[pick.recording].axis_moving(pick.sample, i)) continue;
      const double left = s.fit.residual_N[i * stack.size() + n];
      square[i] += left * left;
      count[i] += 1.0;
    }
  }
  return (square.array() / count.array().max(1.0)).sqrt();
}

/// What has a signature of its own, whatever else acts, and what is no name.
bool isBeyondDoubt(const Candidate& c) {
  return c.isMap() || c.periodic() || c.local();
}

}  // namespace

double floorsLeft(const Search& s, const Place& place, const Eigen::VectorXd& left_N) {
  constexpr double kLeast_N = 1e-12;
  if (place.actuator < 0) return left_N.norm() / std::max(kLeast_N, s.floor.rms_N.norm());
  return left_N[place.actuator] / std::max(kLeast_N, s.floor.rms_N[place.actuator]);
}

void doubtNames(Search& s, std::vector<std::string>& notes) {
  const Eigen::VectorXd left_N = movingRms(s);
  for (FoundEffect& e : s.effects) {
    const Place& place = e.hypothesis.place;
    // Those of a given model were named where they were found.
    if (std::isnan(e.p) || isBeyondDoubt(*place.candidate)) continue;
    const double floors = floorsLeft(s, place, left_N);
    const bool harms = !e.transfers && e.elsewhere_gain < 0.0;
    const bool uneven = e.elsewhere_gaining < kMostStretches;
    if (floors <= kRightLeaves && !harms && !uneven) continue;
    double doubted = e.probability * std::min(1.0, std::pow(kRightLeaves / floors, 2));
    if (harms || uneven) doubted = std::min(doubted, kHarmful);
    e.probability = s.floor.measured ? doubted : std::max(doubted, std::min(kEven, e.probability));
    e.doubted = e.probability < kEven;
    if (e.probability < kSureOfName && !e.doubted) e.indistinguishable_from.emplace_back("unnamed");
    if (floors > kRightLeaves)
      notes.push_back(placeText(place) + ": the model with it still leaves " + shortNumber(floors, 2) +
                      " times the noise floor while axes move: it may stand for something that no name is known for.");
    if (harms)
      notes.push_back(placeText(place) + ": makes the error larger at held-back positions, where what it is called " +
                      "would act as well: it may stand for something else.");
    if (uneven && !harms)
      notes.push_back(
          placeText(place) + ": helps at " + shortNumber(100.0 * e.elsewhere_gaining, 2) +
          " % of the held-back positions only, and what it is called would act at all of them: it may stand "
          "for something else.");
  }
}

}  // namespace knee_robot::tracing
