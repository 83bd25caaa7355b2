// What warms the drives up: the clock, their time in motion, or work. The search knows the clock alone.

#include "settle_heat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "effects/common/warm_up.h"
#include "knee_robot/dynamics/warming.h"
#include "refine.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

using dynamics::Heat;

/// Standard errors by which another heat must be better than the clock to be taken, since friction that warms up by the
/// clock is no more likely beforehand; and to be sure of it.
constexpr double kTakenErrors = 1.0, kSureErrors = 2.0;
constexpr int kRounds = 2, kRoundsOfOthers = 5;  ///< of refinement, each by a half of a time constant at most
constexpr double kLeastDry_N = 0.1;

bool warms(const FoundEffect& e, const Candidate* kind) {
  return e.hypothesis.place.candidate == kind && !std::isnan(e.p) && dynamic_cast<const WarmUp*>(kind) != nullptr;
}

Eigen::VectorXd heldBackAsIs(Search& s, const Eigen::VectorXd& noise_N) {
  refit(s);
  s.rms_N = noise_N;  // all weighted alike
  return problemOf(s, hypothesesOf(s.effects)).heldBack();
}

/// A hypothesis, and how it is said.
struct Heated {
  Heat by;
  bool viscous;  ///< viscous friction heats, too
  const char* said;
  bool levels_off = false;  ///< what warmth changes, changes less and less
};
constexpr Heated kHeats[] = {{Heat::Motion, false, "the time in motion"},
                             {Heat::Work, false, "the work of dry friction"},
                             {Heat::Work, true, "the work of friction"},
                             {Heat::Worked, true, "the work of friction so far, each joule less than the one before,"},
                             {Heat::Winding, false, "what the motor's windings lose, the square of its force,"},
                             {Heat::Work, false, "the work of dry friction, doing less the warmer it is,", true},
                             {Heat::Work, true, "the work of friction, doing less the warmer it is,", true}};
constexpr double kLevelsOff = 1.0;  ///< from which it is refined

/// Standard errors by which a heat must be better than the clock: what weakens a motor is its windings' heat.
double neededErrors(const Heated& heat) {
  return heat.by == Heat::Winding ? 0.0 : kTakenErrors;
}

/// Where the shape of `kind` says at which force the windings' heat is 1; below 0: they are not what warms it up.
int usualForceIn(const Candidate* kind) {
  return dynamic_cast<const WarmUp&>(*kind).usualForce();
}

/// Where it says whether what warmth changes levels off; below 0: it does not.
int levelsOffIn(const Candidate* kind) {
  return dynamic_cast<const WarmUp&>(*kind).levelsOff();
}

/// Root mean square of an actuator's force along all recordings, N.
double usualForceOf(const Search& s, int actuator) {
  double squares = 0.0, samples = 0.0;
  for (const EffectInput& input : s.data->inputs) {
    squares += input.force_N.col(actuator).squaredNorm();
    samples += input.samples();
  }
  return std::sqrt(squares / std::max(1.0, samples));
}

/// Viscous per dry friction of an actuator, in the current model.
double viscousPerDry(const Search& s, int actuator) {
  const EffectInput& input = s.data->inputs.front();
  return std::clamp(input.viscous[actuator] / std::max(kLeastDry_N, input.coulomb_N[actuator]), 0.0,
                    WarmUp::kMostViscous_s_per_m);
}

/// Held-back squares with the drives warmed up by `heat`, with time constants that suit it; weighted with `noise_N`.
Eigen::VectorXd heldBackWith(Search& s, const Candidate* kind, const Heated& heat, const Eigen::VectorXd& noise_N) {
  const auto each = [&](const auto& change) {
    for (FoundEffect& e : s.effects) {
      if (warms(e, kind)) change(e.hypothesis);
    }
  };
  bool suits = true;
  const int levels = levelsOffIn(kind), usual = usualForceIn(kind);
  each([&](Hypothesis& h) {
    suits = suits && h.shape[WarmUp::kHeatedBy] == dynamics::numberOf(heat.by) &&
            (h.shape[WarmUp::kViscousHeat] > 0.0) == heat.viscous &&
            (levels < 0 || (h.shape[static_cast<std::size_t>(levels)] > 0.0) == heat.levels_off);
  });
  std::set<double> constants;
  for (const std::vector<double>& shape : kind->shapes(s.data->inputs.front(), 0))
    constants.insert(shape[0]);
  if (suits) constants.clear();  // they are refined already; those of another heat may be far from them
  std::vector<FoundEffect> best = s.effects;
  double least = std::numeric_limits<double>::infinity();
  for (const double constant_s : constants) {
    each([&](Hypothesis& h) {
      h.shape[0] = constant_s;
      h.shape[WarmUp::kHeatedBy] = dynamics::numberOf(heat.by);
      h.shape[WarmUp::kViscousHeat] = heat.viscous ? viscousPerDry(s, h.place.actuator) : 0.0;
      if (heat.by == Heat::Winding) h.shape[static_cast<std::size_t>(usual)] = usualForceOf(s, h.place.actuator);
      if (levels >= 0) h.shape[static_cast<std::size_t>(levels)] = heat.levels_off ? kLevelsOff : 0.0;
    });
    const double left = heldBackAsIs(s, noise_N).sum();
    if (left >= least) continue;
    least = left;
    best = s.effects;
  }
  s.effects = best;
  for (int round = 0; round < (suits ? kRounds : kRoundsOfOthers); ++round)
    refineShapes(s);
  return heldBackAsIs(s, noise_N);
}

/// Whether `kind` can be warmed up by it; what levels off by all work only where work is better than all before.
bool isAsked(const Candidate* kind, const Heated& heat, const Heated& best) {
  if (heat.by == Heat::Winding) return usualForceIn(kind) >= 0;
  return !heat.levels_off || (levelsOffIn(kind) >= 0 && (!heat.viscous || best.by == Heat::Work));
}

std::string saidOf(const Candidate* kind, const Heated& heat, bool sure) {
  return "What warms the drives up (" + kind->name() + ") is " + heat.said +
         " rather than the clock: held-back blocks are " +
         (sure ? "surely predicted better."
               : "predicted better, but not surely; a slow recording beside a brisk one, or long rests, would tell.");
}

}  // namespace

std::string settleHeat(Search& s, const Candidate* kind) {
  if (std::none_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) { return warms(e, kind); })) return "";
  const std::vector<FoundEffect> found = s.effects;
  const Heated by_clock = {Heat::Clock, false, ""};
  const Eigen::VectorXd noise_N = s.rms_N, clock = heldBackWith(s, kind, by_clock, noise_N);
  std::vector<FoundEffect> best = s.effects;
  Heated best_heat = by_clock;
  Eigen::VectorXd least = clock;
  bool surely = true;  // no other heat is near
  std::string said;
  for (const Heated& heat : kHeats) {
    if (!isAsked(kind, heat, best_heat)) continue;
    s.effects = found;
    const Eigen::VectorXd other = heldBackWith(s, kind, heat, noise_N);
    const HeldBackGain gain = heldBackGain(clock - other);
    if (gain.mean > -kSureErrors * gain.error) surely = false;
    // What has one shape more must surely be better than the same without it.
    const HeldBackGain more = heat.levels_off && !best_heat.levels_off ? heldBackGain(least - other) : gain;
    if (more.mean <= neededErrors(heat) * more.error || other.sum() >= least.sum()) continue;
    least = other;
    best = s.effects;
    best_heat = heat;
    said = saidOf(kind, heat, gain.mean > kSureErrors * gain.error);
  }
  s.effects = best;
  refit(s);
  if (!said.empty() || surely) return said;
  return "Whether the drives warm up (" + kind->name() +
         ") by the clock or by their motion the recordings do not tell; the clock is taken. "
         "A slow recording beside a brisk one, or long rests, would tell.";
}

}  // namespace knee_robot::tracing
