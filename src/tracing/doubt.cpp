// A name is only as good as what the model with it leaves.

#include "doubt.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "came_back.h"
#include "knee_robot/base/numbers.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

/// Most for a name that harms at held-back positions: none of 48 right ones on 44 machines did.
constexpr double kHarmful = 0.45;
/// Share of held-back stretches that must gain by what a name says: 30 right ones on 9 machines gained in 0.92 or more,
/// names for something that has none in 0.67.
constexpr double kMostStretches = 0.7;
/// Floors beyond which more than noise is left: 46 right names on 14 machines left at most 1.3.
constexpr double kMoreThanNoise = 1.5;

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

/// What encoders have lost for good is so much (m) that forces are those of another pose: 15 kg on legs half a metre
/// long weigh half a newton less or more.
constexpr double kLost_m = 1e-3;

/// What speaks against every name where an axis is not where the recording says: empty where none is. A frozen encoder
/// that goes on where the axis is by then has lost nothing.
std::string lostPosition(const Search& s) {
  for (const identification::Observation& o : s.data->recordings) {
    Eigen::VectorXd lost_m = Eigen::VectorXd::Zero(s.data->stack.axes);
    for (const recording::Jump& jump : o.signals.jumps)
      lost_m[jump.axis] += jump.frozen_s > 0.0 ? 0.0 : jump.beyond_m;
    Eigen::Index axis = 0;
    const double most_m = lost_m.cwiseAbs().maxCoeff(&axis);
    if (most_m > kLost_m)
      return ": in " + o.name + " the position of actuator " + std::to_string(axis + 1) + " jumps by " +
             shortNumber(1e3 * most_m, 3) +
             " mm and does not come back: before or after it the robot is not where the model takes it to be, and what "
             "was found may be that.";
  }
  return {};
}

/// What has a signature of its own, whatever else acts, and what is no name.
bool isBeyondDoubt(const Candidate& c) {
  return c.isMap() || c.periodic() || c.local();
}

/// A force on the platform goes into several legs, unless it points along one.
constexpr double kMostInOneLeg = 0.999;
constexpr double kMostlyCovered = 0.5;
constexpr double kEither = 0.7;  ///< a push, or what depends on a place

/// Of a push: whether it may be something in one leg, or something that depends on a place where the robot was once.
void doubtPush(const Search& s, FoundEffect& e, std::vector<std::string>& notes) {
  const Place& place = e.hypothesis.place;
  const bool has_legs = !s.data->inputs.front().force_per_pose_force.empty();
  if (has_legs && shareOfOneActuator(s, e.hypothesis, e.coefficients) > kMostInOneLeg) {
    e.probability = std::min(e.probability, kHarmful);
    e.doubted = true;
    notes.push_back(placeText(place) + ": loads one leg alone; what pushes the platform loads several.");
    return;
  }
  const Eigen::VectorXd without_N = s.fit.residual_N + effectRows(*s.data, e.hypothesis) * e.coefficients;
  if (recurrenceOf(s, e.hypothesis, without_N).covered >= kMostlyCovered) return;
  e.probability = std::min(e.probability, kEither);
  e.indistinguishable_from.emplace_back("unnamed");
  notes.push_back(placeText(place) +
                  ": happened at places where the robot was at no other time, and may belong to them.");
}

/// What has no name: maps, and names that a map explains better.
std::vector<FoundEffect> withoutName(const Search& s) {
  std::vector<FoundEffect> out;
  std::copy_if(s.effects.begin(), s.effects.end(), std::back_inserter(out),
               [](const FoundEffect& e) { return e.doubted || e.hypothesis.place.candidate->isMap(); });
  return out;
}

/// Most that one of `nameless` explains on the same actuator (for a shared effect: on all together).
double explainedWithoutName(const std::vector<FoundEffect>& nameless, const Place& place) {
  double most_N = 0.0;
  for (const FoundEffect& e : nameless) {
    const Place& other = e.hypothesis.place;
    if (!(other == place) && (place.actuator < 0 || other.actuator == place.actuator))
      most_N = std::max(most_N, atPlace(place, e.explained_rms_N));
  }
  return most_N;
}

/// Why `e` may be part of something larger that has no name; empty: nothing larger is there.
std::string partOfNameless(const std::vector<FoundEffect>& nameless, const FoundEffect& e) {
  const Place& place = e.hypothesis.place;
  const double own_N = atPlace(place, e.explained_rms_N), nameless_N = explainedWithoutName(nameless, place);
  if (nameless_N <= own_N) return {};
  return ": explains " + shortNumber(own_N, 2) + " N, less than what no name is known for there (" +
         shortNumber(nameless_N, 2) + " N): it may be part of that.";
}

/// A special case of it, or what it is a special case of, was added at the same place: had either been right, it alone
/// would have done.
bool besideItsKin(const Search& s, const FoundEffect& e) {
  const Place& place = e.hypothesis.place;
  const auto isKin = [&](const FoundEffect& other) {
    const Candidate &a = *place.candidate, &b = *other.hypothesis.place.candidate;
    return other.hypothesis.place.actuator == place.actuator && !std::isnan(other.p) &&
           (a.generalizes() == b.name() || b.generalizes() == a.name());
  };
  return std::any_of(s.effects.begin(), s.effects.end(), isKin);
}

/// What speaks against a name where it is known how much noise there is.
std::vector<std::string> reasonsAgainst(const Search& s, const FoundEffect& e) {
  const Candidate& c = *e.hypothesis.place.candidate;
  std::vector<std::string> reasons;
  if (besideItsKin(s, e))
    reasons.emplace_back(
        ": was added beside its own special case; had either name been right, it would have explained both: they may "
        "stand for something else.");
  if (e.coefficients.size() > 0 && !c.believable(e.coefficients))
    reasons.emplace_back(": is larger than anything of this name can be: it may stand for something else.");
  if (c.looksLikeMuch())
    reasons.emplace_back(": so much looks like one that the name alone says little: it may stand for something else.");
  if (!e.transfers && e.elsewhere_gain < 0.0)
    reasons.emplace_back(
        ": makes the error larger at held-back positions, where what it is called would act as well: it may stand for "
        "something else.");
  else if (e.elsewhere_gaining < kMostStretches)
    reasons.push_back(": helps at " + shortNumber(100.0 * e.elsewhere_gaining, 2) +
                      " % of the held-back positions only, and what it is called would act at all of them: it may "
                      "stand for something else.");
  return reasons;
}

/// The same of what the model with it leaves while axes move.
std::string lessThanWhatIsLeft(const FoundEffect& e, double left_N, double floors) {
  const double own_N = atPlace(e.hypothesis.place, e.explained_rms_N);
  if (floors <= kMoreThanNoise || left_N <= own_N) return {};
  return ": explains " + shortNumber(own_N, 2) + " N, less than what is left there while axes move (" +
         shortNumber(left_N, 2) + " N, " + shortNumber(floors, 2) + " times the noise floor): it may be part of that.";
}

/// Probability that a name keeps, and why.
double doubtedProbability(const Search& s, const std::vector<FoundEffect>& nameless, const FoundEffect& e,
                          const Eigen::VectorXd& all_left_N, std::vector<std::string>& reasons) {
  const double floors = floorsLeft(s, e.hypothesis.place, all_left_N), left_N = atPlace(e.hypothesis.place, all_left_N);
  reasons = reasonsAgainst(s, e);
  const std::string less = lessThanWhatIsLeft(e, left_N, floors);
  if (!less.empty()) reasons.push_back(less);
  double probability = reasons.empty() ? e.probability : std::min(e.probability, kHarmful);
  // An estimated floor takes no name away: not that of a pair either, which is below even because there are two.
  if (floors > kRightLeaves && (s.floor.measured || e.probability > kEven)) {
    probability = std::min(probability, e.probability * std::pow(kRightLeaves / floors, 2));
    reasons.push_back(": the model with it still leaves " + shortNumber(floors, 2) +
                      " times the noise floor while axes move: it may stand for something that no name is known for.");
  }
  if (!s.floor.measured) probability = std::max(probability, std::min(kEven, e.probability));
  const std::string part = partOfNameless(nameless, e);
  if (part.empty()) return probability;
  reasons.push_back(part);  // needs no floor: the other one is there
  return std::min(probability, kHarmful);
}

}  // namespace

double atPlace(const Place& place, const Eigen::VectorXd& per_actuator_N) {
  if (per_actuator_N.size() == 0) return 0.0;
  return place.actuator < 0 ? per_actuator_N.norm() : per_actuator_N[place.actuator];
}

double floorsLeft(const Search& s, const Place& place, const Eigen::VectorXd& left_N) {
  constexpr double kLeast_N = 1e-12;
  return atPlace(place, left_N) / std::max(kLeast_N, atPlace(place, s.floor.of_names_N));
}

void doubtNames(Search& s, std::vector<std::string>& notes) {
  const Eigen::VectorXd left_N = movingRms(s);
  const std::vector<FoundEffect> nameless = withoutName(s);
  const std::string lost = lostPosition(s);
  for (FoundEffect& e : s.effects) {
    const Place& place = e.hypothesis.place;
    // Those of a given model were named where they were found.
    if (std::isnan(e.p)) continue;
    if (place.candidate->local()) doubtPush(s, e, notes);
    if (!lost.empty() && !place.candidate->isMap()) {
      e.probability = std::min(e.probability, kHarmful);
      e.doubted = true;
      notes.push_back(placeText(place) + lost);
    }
    if (isBeyondDoubt(*place.candidate)) continue;
    std::vector<std::string> reasons;
    const double probability = doubtedProbability(s, nameless, e, left_N, reasons);
    if (reasons.empty()) continue;
    e.probability = probability;
    e.doubted = e.probability < kEven;
    if (e.probability < kSureOfName && !e.doubted) e.indistinguishable_from.emplace_back("unnamed");
    for (const std::string& reason : reasons)
      notes.push_back(placeText(place) + reason);
  }
}

}  // namespace knee_robot::tracing
