#pragma once

#include <cstdint>
#include <vector>

#include "knee_robot/tracing/hypothesis.h"
#include "knee_robot/tracing/twin.h"

namespace knee_robot::tracing {

/// The current model: baseline parameters and effects found so far.
struct TwinModel {
  Eigen::VectorXd parameters;
  std::vector<Hypothesis> effects;
  std::vector<Eigen::VectorXd> coefficients;
};

/// Forces of the model's effects along a recording, samples x axes, N.
TwinEffects effectForces(const EffectInput& input, const TwinModel& model);

/// Twins of all training recordings that have the model's effects and no other: `count` times the whole set, each with other
/// encoder phases. Their regressors are reduced to base coordinates. Runs in two threads.
std::vector<TraceData> makeTwins(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                                 const TraceData& data, const BaseFit& base, const TwinModel& model,
                                 const std::vector<TwinPlan>& plans, const identification::ObservationOptions& options,
                                 int count, std::uint64_t seed);

/// What such twins leave, rms per actuator in N: median over the twins from `first` on.
Eigen::VectorXd twinResidual(const std::vector<TraceData>& twins, const BaseFit& base,
                             const std::vector<Hypothesis>& effects, int first = 0);

/// What clean twins explain by chance, place by place. A draw is a twin's own artefact plus `residual_N` (what the best
/// hypothesis leaves of the real data: the effect itself is no noise), resampled in blocks with random sign, so that it keeps its
/// size and colour but not its cause. As a value counts the root of the explained share of squared noise_N, the best shape of
/// each place; values are standardized place by place, because artefacts favour some hypotheses (a delay) over others, and the
/// null is the largest standardized value of all places that explain enough to be accepted.
struct NullDistribution {
  std::vector<Place> places;
  Eigen::VectorXd mean, spread;  ///< per place, of the root of the share
  std::vector<double> largest;   ///< per draw, over all places; ascending
  bool hopeless = false;         ///< ended early: none of the hopes can pass any more

  /// Standardized value of a share at a place.
  double standardized(const Place& place, double share) const;
  /// Root of the share that a place would need to reach the largest null value.
  double threshold(const Place& place) const;
};
/// Place and share that must beat the null.
using Hope = std::pair<Place, double>;

/// Ends early when the first twins already exceed all `hopes` so often that no p below `largest_p` can come of it.
NullDistribution nullDistribution(const std::vector<TraceData>& twins, const TraceData& data,
                                  const Eigen::VectorXd& residual_N, const Eigen::VectorXd& noise_N,
                                  const std::vector<Hypothesis>& accepted, const std::vector<Hypothesis>& tried,
                                  const std::vector<Hope>& hopes, double largest_p, int draws, std::uint64_t seed);

/// Monte Carlo p: (1 + null values that reach `value`) / (1 + null values).
double monteCarloP(const std::vector<double>& null_values, double value);

/// Weighted columns of the model: base, then effects.
Eigen::MatrixXd modelColumns(const TraceData& data, const Eigen::VectorXd& noise_N,
                             const std::vector<Hypothesis>& effects);

}  // namespace knee_robot::tracing
