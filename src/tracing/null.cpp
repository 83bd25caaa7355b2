#include "null.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/base/parallel.h"

namespace knee_robot::tracing {
namespace {

constexpr double kStill_N = 1e-9;     ///< a smaller step of what settles is rounding
constexpr double kSteepest = 0.95;    ///< share of a command that is not given: more of it does not settle
constexpr double kResampled_s = 1.5;  ///< of resampled noise: several correlation times of the low-passed residual

/// Sets a recording's forces to those of the model, effects that look at the force included.
void setModelForces(EffectInput& input, const BaseFit& base, const SurrogateModel& model) {
  lookAhead(input, model);
  (void)settleForces(input, base.columns, model.parameters, model);
}

Surrogate makeSurrogate(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                        const TraceData& data, const BaseFit& base, const SurrogateModel& model,
                        const std::vector<SurrogatePlan>& plans, const identification::ObservationOptions& options,
                        std::uint64_t seed) {
  TraceData surrogate;
  surrogate.stack = data.stack;
  const int count = static_cast<int>(recordings.size());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const recording::Recording simulated =
        simulateSurrogate(robot, recordings[r], data.recordings[r], plans[r], seed * 1000003u + 17u * r);
    surrogate.recordings.push_back(identification::observe(robot, base.columns, simulated, options));
    if (surrogate.recordings.back().samples() != data.recordings[r].samples())
      surrogate.recordings.back() = data.recordings[r];
    identification::setFriction(surrogate.recordings.back(), base.columns, base.friction_laws);
  }
  const BaseFit newtons = inNewtons(base);
  Surrogate s;
  s.pull = base.pull;
  s.force_rows = forceRows(newtons, surrogate.recordings, surrogate.stack);
  const Eigen::MatrixXd base_rows = baseRows(newtons, surrogate.recordings, surrogate.stack);
  for (int r = 0; r < count && !model.effects.empty(); ++r) {
    surrogate.inputs.push_back(
        effectInput(robot, surrogate.recordings[static_cast<std::size_t>(r)], newtons.friction_laws, r, count));
    setModelForces(surrogate.inputs.back(), base, model);
  }
  surrogate.scale = Eigen::VectorXd::Ones(s.force_rows.size());
  std::vector<Eigen::MatrixXd> effects;
  Eigen::Index columns = base_rows.cols();
  for (const Hypothesis& h : model.effects) {
    effects.push_back(effectRows(surrogate, h));
    columns += effects.back().cols();
  }
  s.model_rows.resize(base_rows.rows(), columns);
  s.model_rows.leftCols(base_rows.cols()) = base_rows;
  Eigen::Index at = base_rows.cols();
  for (const Eigen::MatrixXd& part : effects) {
    s.model_rows.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return s;
}

/// Weighted residual of a surrogate, its own model refitted.
Eigen::VectorXd leftOf(const Surrogate& s, const TraceData& data, const Eigen::VectorXd& noise_N) {
  return leftBy(weighted(data.stack, data.scale.asDiagonal() * s.model_rows, noise_N),
                weighted(data.stack, data.scale.asDiagonal() * s.force_rows, noise_N), s.pull);
}

/// Blocks of the real residual, all actuators together, at random places with random signs.
Eigen::VectorXd resampled(const Stack& stack, const Eigen::VectorXd& residual, std::mt19937_64& random) {
  const Eigen::Index p = stack.size();
  const Eigen::Index block = std::clamp<Eigen::Index>(std::lround(kResampled_s * stack.rate_hz), 2, p);
  Eigen::VectorXd out(p * stack.axes);
  for (Eigen::Index at = 0; at < p; at += block) {
    const Eigen::Index from = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(p));
    const double sign = random() % 2 ? 1.0 : -1.0;
    for (Eigen::Index k = 0; k < std::min(block, p - at); ++k) {
      for (int i = 0; i < stack.axes; ++i)
        out[i * p + at + k] = sign * residual[i * p + (from + k) % p];
    }
  }
  return out;
}

}  // namespace

std::vector<Surrogate> makeSurrogates(const mechanism::Robot& robot,
                                      const std::vector<recording::Recording>& recordings, const TraceData& data,
                                      const BaseFit& base, const SurrogateModel& model,
                                      const std::vector<SurrogatePlan>& plans,
                                      const identification::ObservationOptions& options, int count,
                                      std::uint64_t seed) {
  std::vector<Surrogate> all(static_cast<std::size_t>(count));
  inParallel(all.size(), [&](std::size_t k) {
    all[k] = makeSurrogate(robot, recordings, data, base, model, plans, options, seed * 7919u + k + 1u);
  });
  return all;
}

SurrogateEffects effectForces(const EffectInput& input, const SurrogateModel& model) {
  SurrogateEffects out;
  out.friction_N = out.load_N = out.drive_N = Eigen::MatrixXd::Zero(input.samples(), input.axes());
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    const Candidate& candidate = *model.effects[k].place.candidate;
    Eigen::MatrixXd& kind = candidate.isFriction() ? out.friction_N : candidate.ofDrive() ? out.drive_N : out.load_N;
    Eigen::Index actuator = model.effects[k].place.actsOnAll() ? 0 : model.effects[k].place.actuator;
    for (const Eigen::MatrixXd& columns : actingColumns(input, model.effects[k]))
      kind.col(actuator++) += columns * model.coefficients[k];
  }
  out.load_N += out.drive_N;
  return out;
}

SurrogateEffects settleForces(EffectInput& input, const std::vector<identification::Column>& columns,
                              const Eigen::VectorXd& seen, const SurrogateModel& model) {
  const auto next = [&](const SurrogateEffects& now) {
    setEffects(input, now.friction_N + now.load_N, now.drive_N);
    return effectForces(input, model);
  };
  setModel(input, columns, seen);
  if (model.effects.empty()) return effectForces(input, model);
  const SurrogateEffects first = effectForces(input, model), second = next(first);
  if (second.load_N == first.load_N) return second;
  SurrogateEffects settled = next(second);
  // Each step adds the same share of the one before: a geometric series, actuator by actuator.
  for (int i = 0; i < input.axes(); ++i) {
    const Eigen::VectorXd step = second.load_N.col(i) - first.load_N.col(i),
                          last = settled.load_N.col(i) - second.load_N.col(i);
    const double share = step.norm() > kStill_N ? std::min(kSteepest, last.dot(step) / step.squaredNorm()) : 0.0;
    settled.load_N.col(i) += last * share / (1.0 - share);
  }
  settled = next(settled);  // what changes with time is no series
  setEffects(input, settled.friction_N + settled.load_N, settled.drive_N);
  return settled;
}

void lookAhead(EffectInput& input, const SurrogateModel& model) {
  input.ahead_s.setZero();
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    const Place& place = model.effects[k].place;
    if (place.candidate->leads() && model.coefficients[k].size() > 0)
      input.ahead_s[place.actuator] += model.coefficients[k][0];
  }
}

Eigen::VectorXd surrogateResidual(const std::vector<Surrogate>& surrogates, const TraceData& data,
                                  const BaseFit& base) {
  Eigen::MatrixXd left(data.stack.axes, static_cast<Eigen::Index>(surrogates.size()));
  inParallel(surrogates.size(), [&](std::size_t k) {
    left.col(static_cast<Eigen::Index>(k)) = rmsRows(base, data.stack, leftOf(surrogates[k], data, base.noise_N));
  });
  Eigen::VectorXd median = Eigen::VectorXd::Zero(left.rows());
  for (Eigen::Index i = 0; i < left.rows() && left.cols() > 0; ++i) {
    Eigen::VectorXd row = left.row(i).transpose();
    std::sort(row.data(), row.data() + row.size());
    median[i] = row[row.size() / 2];
  }
  return median;
}

Eigen::MatrixXd nullResiduals(const std::vector<Surrogate>& surrogates, const TraceData& data,
                              const Eigen::VectorXd& residual_N, const Eigen::VectorXd& noise_N,
                              const Projection& projection, int draws, std::uint64_t seed) {
  const Eigen::VectorXd residual = weighted(data.stack, residual_N, noise_N);
  Eigen::MatrixXd own(residual.size(), static_cast<Eigen::Index>(surrogates.size()));
  inParallel(surrogates.size(),
             [&](std::size_t k) { own.col(static_cast<Eigen::Index>(k)) = leftOf(surrogates[k], data, noise_N); });
  std::mt19937_64 random(seed);
  Eigen::MatrixXd out(residual.size(), draws);
  for (int d = 0; d < draws; ++d)
    out.col(d) = own.col(d % own.cols()) + resampled(data.stack, residual, random);
  return out - projection.q * (projection.q.transpose() * out);
}

Eigen::MatrixXd modelColumns(const TraceData& data, const Eigen::VectorXd& noise_N,
                             const std::vector<Hypothesis>& effects) {
  const std::vector<Eigen::MatrixXd> rows = effectRows(data, effects);
  Eigen::Index columns = data.base_rows.cols();
  for (const Eigen::MatrixXd& part : rows)
    columns += part.cols();
  Eigen::MatrixXd all(data.base_rows.rows(), columns);
  Eigen::Index at = data.base_rows.cols();
  all.leftCols(at) = data.base_rows;
  for (const Eigen::MatrixXd& part : rows) {
    all.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return weighted(data.stack, std::move(all), noise_N);
}

}  // namespace knee_robot::tracing
