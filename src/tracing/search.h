#pragma once

#include <functional>

#include "floor.h"
#include "knee_robot/tracing/trace_result.h"
#include "library.h"
#include "null.h"

namespace knee_robot::tracing {

/// The state of the search: what is in the model, and how well it fits.
struct Search {
  TraceData* data = nullptr;
  BaseFit* base = nullptr;
  Library* library = nullptr;  ///< columns of everything that may be added
  /// What other laws of friction near rest would change: rows in N, not scaled. Nothing is found that they explain as
  /// well.
  Eigen::MatrixXd near_rest;
  Attention attention = Attention::All;
  bool maps = true;                          ///< unnamed ones compete too
  std::vector<Surrogate> surrogates;         ///< with the effects found so far
  std::function<void()> rebuild_surrogates;  ///< after the model has changed; sets the floor too
  const TraceOptions* options = nullptr;
  NoiseFloor floor;
  std::vector<Place>
      absorbed;  ///< the baseline's own columns do the same: such an effect and they would take any value together
  std::vector<FoundEffect> effects;
  JointFit fit;
  Eigen::VectorXd seen_parameters;     ///< of the baseline, that loads and friction in the effects' columns rest on
  Eigen::VectorXd rms_N;               ///< per actuator, of fit
  std::vector<std::string> rejected;   ///< why the search ended
  std::vector<std::string> taken_out;  ///< what was found and did not stay
};

/// Root mean square per actuator of rows in N.
Eigen::VectorXd rmsOf(const Stack& stack, const Eigen::VectorXd& residual_N);

/// Hypotheses of the effects found so far.
std::vector<Hypothesis> hypothesesOf(const std::vector<FoundEffect>& effects);

/// Base and these effects along the recordings, weighted with the search's rms.
JointProblem problemOf(const Search& search, const std::vector<Hypothesis>& effects);

/// Those fitted together, with every block left out in turn.
JointFit fitOf(const Search& search, const std::vector<Hypothesis>& effects, LeftOut left_out = LeftOut::EveryBlock);

/// The model as it stands.
SurrogateModel modelOf(const Search& search);

/// Fits base and effects together and rebuilds what depends on the fit (loads, forces), twice.
void refit(Search& search);

/// Fits the baseline and chooses its laws of friction near rest anew, with the effects' forces taken off, and fits
/// again.
/// True when the law of friction has changed.
bool rebase(Search& search);

/// Puts another baseline under the effects, with its laws near rest, and fits again. True when those laws are others.
bool adoptBase(Search& search, BaseFit base);

/// Decides for all effects of one kind whether their friction builds up near rest by the actuators' law or by a smooth
/// one of its own:
/// either way the actuators' law is chosen anew beside it, and held-back blocks compare. True when that law may have
/// changed.
bool settleRestLaw(Search& search, const Candidate* kind);

/// Fills search.near_rest for the law that the base has now.
void updateNearRest(Search& search);

/// Least squares onto the model as it stands (`effects`), and what other laws near rest would change.
Projection projectModel(const Search& search, const std::vector<Hypothesis>& effects);
/// Those columns: the base's, the effects' in their order, other laws'.
Eigen::MatrixXd projectedColumns(const Search& search, const std::vector<Hypothesis>& effects);

/// Share of the squared noise that friction of one actuator explains beyond the laws near rest that it might have
/// instead. A law is a mixture of shares that are positive: what only their difference explains (dry friction that is
/// larger while creeping) is no law.
double shareBeyondLaws(const Search& search, const Hypothesis& friction);

/// Adds what the library holds, named effects and maps in the same pass, one after the other while they pass every
/// test; the same effect on other actuators follows at once. At most `most` additions, those not counted.
void searchForward(Search& search, int most, std::uint64_t seed);

/// Takes out, the least needed first, effects without which held-back blocks are predicted as well; those of a given
/// model included.
void eliminateBackward(Search& search);

/// Takes out periodic effects that do not go on at positions which were held back, with all samples and while axes
/// move: remainders of a few stops look like a ripple of a short period, too.
void dropWhatDoesNotRepeat(Search& search);

/// Takes out what is something else with the shape that was refined beside others. Not those of a given model.
void dropImplausible(Search& search);

/// A new effect that acts on all actuators may be what several others stood for together: those are taken out at once
/// where held-back blocks are predicted as well without them, its shape refined alone, within a standard error.
void standAlone(Search& search, const Place& place);

/// Puts the special case in place of an effect that generalizes it (a spring for a curve over the distance), where
/// held-back blocks are predicted no worse by it: while shapes are rough, what bends more fits better.
void simplify(Search& search);

/// Puts an effect that was found on another actuator in place of a map, where held-back blocks are predicted as well by
/// it, within a standard error: screws of one machine are alike.
void replaceMaps(Search& search);

/// Dead time and lag of a drive are the same to first order: decides for all actuators together by what they are beyond
/// it, on held-back blocks; the rival is named where they cannot be told apart.
void settleLeads(Search& search);

/// Decides for all drives that warm up by effects of one kind together what warms them: the clock, unless held-back
/// blocks are predicted surely better by their time in motion or by their work. A sentence; empty: nothing warms up, or
/// the clock is sure.
std::string settleHeat(Search& search, const Candidate* kind);

/// Takes out what leads where that helps near rest only: where an axis sticks, the force that builds up before it breaks
/// away runs ahead of the motion, too.
void dropLeadsOfRest(Search& search);

/// Refines the shapes of all effects together: variable projection, coefficients solved for at every step.
void refineShapes(Search& search);

/// Least share of the squares that an effect of a parallel robot must save at held-back positions: less than that may cost more on another
/// path. Right ones on 14 machines of two independent simulators saved half of them or more.
inline constexpr double kWorthElsewhere = 0.05;

/// Held-back stretches of other positions, and samples with a masked pose: what each effect saves there. Effects that
/// do not surely help there are not predicted elsewhere.
void testElsewhere(Search& search, std::vector<std::string>& notes);
/// The same of a chain, whose reports name nothing that fails there: it is taken out, the most harmful one first.
void abstainElsewhere(Search& search, std::vector<std::string>& notes);

/// Whether what is predicted elsewhere predicts held-back stretches of other positions surely better than the baseline,
/// with its own laws near rest, does. False where no effect is predicted elsewhere.
bool helpsElsewhere(Search& search, const BaseFit& baseline);

/// What is predicted in other recordings.
struct ElsewhereFit {
  std::vector<FoundEffect> effects;
  Eigen::VectorXd parameters, seen_parameters;
};

/// Fits base and laws near rest without the effects that do not transfer (but for pushes: what they did to training must
/// not go into the parameters), then all effects again on that base: laws that were chosen beside what is left out are
/// wrong, too, and a model has one for all. `keep_laws`: those of a given model, of chains.
ElsewhereFit fitElsewhere(Search& search, bool keep_laws);

/// Takes out ripples, pushes and thermal drifts that explain less than a noise floor on every actuator, and unnamed
/// maps below two, but for those that themselves help at held-back positions where the whole surely does (`helps`); and
/// anything below one that does not help there. What goes with time or happened once must, where no floor was measured by
/// repeats, explain what is left, too. Returns how many; the fit is not done anew.
int leaveOutSmall(Search& search, bool helps, std::vector<std::string>& rejected);

/// An effect that depends on a position which always went with another one in training is seen, but not what it depends
/// on: on another path, where the two part, it would predict anything. Such effects are not predicted elsewhere.
void holdBackAmbiguous(Search& search, std::vector<std::string>& notes);

/// Noise floors that models with the right effects leave while axes move, at most 2.1 on 19 machines of two independent
/// simulators; those with names that stand for something else left 2.6 to 11 (docs/results/foreign_machines.md). All of
/// them had repeats. A floor that was estimated says too little to take a name away: where axes stick, a healthy robot
/// leaves ten of them.
constexpr double kRightLeaves = 2.2;

/// Probability of a name below which it is rather none: the effect is reported as unnamed.
constexpr double kEven = 0.5;

/// Noise floors in `left_N` (per actuator) where an effect acts; of one on all actuators, of them together.
double floorsLeft(const Search& search, const Place& place, const Eigen::VectorXd& left_N);

/// The baseline does not describe the one path that was seen (one recording, or several that follow the same): what was
/// found beside it may be anything. `doubts`: TraceResult::doubts.
bool isOnePathNotDescribed(const std::vector<std::string>& doubts,
                           const std::vector<identification::Observation>& recordings);

/// A force that depends on the pose alone, seen along one path only, in a model that leaves much more than the noise
/// floor: what it stands for (a cable chain's hysteresis, a memory) may be another force in the same pose on another
/// path. So may several maps that together do not reach the floor of repeats: along one path everything is a function
/// of anything. Held-back pieces of the one path cannot tell. Such effects are not predicted elsewhere.
void holdBackOnePath(Search& search, std::vector<std::string>& notes);

/// Names of models that leave much more than the noise floor while axes move are less probable, the more they leave;
/// those that are rather wrong than right are doubted.
void doubtNames(Search& search, std::vector<std::string>& notes);

/// "stribeck on actuator 2".
std::string placeText(const Place& place);

}  // namespace knee_robot::tracing
