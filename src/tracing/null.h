#pragma once

#include <cstdint>
#include <vector>

#include "closed_loop_surrogate.h"
#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// The current model: baseline parameters and effects found so far.
struct SurrogateModel {
  Eigen::VectorXd parameters;
  std::vector<Hypothesis> effects;
  std::vector<Eigen::VectorXd> coefficients;
};

/// Forces of the model's effects along a recording, samples x axes, N.
SurrogateEffects effectForces(const EffectInput& input, const SurrogateModel& model);

/// Puts into `input` by how much the model's command runs ahead.
void lookAhead(EffectInput& input, const SurrogateModel& model);

/// Sets the forces of `input` to those of a model whose effects look at the parameters `seen`, and returns those of the
/// effects. What looks at the whole force (a drive's gain) is part of it: settled exactly where it is proportional.
SurrogateEffects settleForces(EffectInput& input, const std::vector<identification::Column>& columns,
                              const Eigen::VectorXd& seen, const SurrogateModel& model);

/// What is kept of one surrogate of all training recordings: it has the model's effects and no other.
struct Surrogate {
  Eigen::MatrixXd model_rows;  ///< base coordinates, then effects; N, not scaled by attention
  Eigen::VectorXd force_rows;  ///< N, not scaled
  Eigen::VectorXd pull;        ///< of the base coordinates, for rows of unit noise
};

/// `count` surrogates, each with other encoder phases, at the picks of the recordings themselves.
std::vector<Surrogate> makeSurrogates(const mechanism::Robot& robot,
                                      const std::vector<recording::Recording>& recordings, const TraceData& data,
                                      const BaseFit& base, const SurrogateModel& model,
                                      const std::vector<SurrogatePlan>& plans,
                                      const identification::ObservationOptions& options, int count, std::uint64_t seed);

/// What such surrogates leave, rms per actuator in N: median over them.
Eigen::VectorXd surrogateResidual(const std::vector<Surrogate>& surrogates, const TraceData& data, const BaseFit& base);

/// Residuals (weighted rows x draws) that hold nothing but what is in the model already. A draw is one surrogate's own
/// artefact plus `residual_N` (what the best hypothesis leaves of the real data: the effect itself is no noise),
/// resampled in blocks with random sign, so that it keeps its size and colour but not its cause. Orthogonal to the
/// projection.
Eigen::MatrixXd nullResiduals(const std::vector<Surrogate>& surrogates, const TraceData& data,
                              const Eigen::VectorXd& residual_N, const Eigen::VectorXd& noise_N,
                              const Projection& projection, int draws, std::uint64_t seed);

/// Weighted columns of the model: base, then effects.
Eigen::MatrixXd modelColumns(const TraceData& data, const Eigen::VectorXd& noise_N,
                             const std::vector<Hypothesis>& effects);

}  // namespace knee_robot::tracing
