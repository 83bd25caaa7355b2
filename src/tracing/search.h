#pragma once

#include <functional>

#include "knee_robot/tracing/floor.h"
#include "knee_robot/tracing/null.h"
#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {

/// The state of the search: what is in the model, and how well it fits.
struct Search {
  TraceData* data = nullptr;
  BaseFit* base = nullptr;
  Attention attention = Attention::All;
  std::vector<TraceData>* twins = nullptr;
  std::function<void()> rebuild_twins;  ///< with the effects found so far; sets the floor too
  const TraceOptions* options = nullptr;
  NoiseFloor floor;
  std::vector<FoundEffect> effects;
  JointFit fit;
  Eigen::VectorXd seen_parameters;  ///< of the baseline, that loads and friction in the effects' columns rest on
  Eigen::VectorXd rms_N;            ///< per actuator, of fit
  std::vector<std::string> rejected;
};

/// Root mean square per actuator of rows in N.
Eigen::VectorXd rmsOf(const Stack& stack, const Eigen::VectorXd& residual_N);

/// Hypotheses of the effects found so far.
std::vector<Hypothesis> hypothesesOf(const std::vector<FoundEffect>& effects);

/// The model as it stands.
TwinModel modelOf(const Search& search);

/// Fits base and effects together and rebuilds what depends on the fit (loads, forces), twice.
void refit(Search& search);

/// Chooses the baseline's directions and the memory of its friction anew, with the effects' forces taken off, and fits again.
void rebase(Search& search);

/// Adds effects of `candidates` one after the other while they pass every test; takes out what a later one makes superfluous.
void searchForward(Search& search, const CandidateList& candidates, int most, std::uint64_t seed);

}  // namespace knee_robot::tracing
