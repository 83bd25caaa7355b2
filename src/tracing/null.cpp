#include "knee_robot/tracing/null.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <random>

namespace knee_robot::tracing {
namespace {

constexpr double kLeastSpread = 0.01;  ///< of a place's null values: absorbed places have none
constexpr double kWorthwhile = 0.4;    ///< lowering the rms by a tenth explains 0.44 of it; less is never accepted
constexpr int kFirstTwins = 4;         ///< after these it may already be hopeless
constexpr double kSurely = 3.0;        ///< draws more than allowed: mean and spread still change a little
constexpr double kBlock_s = 1.5;       ///< of resampled noise: several correlation times of the low-passed residual

/// Sets a recording's forces to those of the model, effects that look at the force included.
void setModelForces(EffectInput& input, const BaseFit& base, const TwinModel& model) {
  setForces(input, base.columns, model.parameters, {});
  if (model.effects.empty()) return;
  const TwinEffects own = effectForces(input, model);
  setForces(input, base.columns, model.parameters, own.friction_N + own.load_N);
}

TraceData makeTwin(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                   const TraceData& data, const BaseFit& base, const TwinModel& model,
                   const std::vector<TwinPlan>& plans, const identification::ObservationOptions& options,
                   std::uint64_t seed) {
  TraceData twin;
  const int count = static_cast<int>(recordings.size());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const recording::Recording simulated =
        simulateTwin(robot, recordings[r], data.recordings[r], plans[r], seed * 1000003u + 17u * r);
    twin.recordings.push_back(identification::observe(robot, base.columns, simulated, options));
    setFriction(twin.recordings.back(), base.columns, base.memory);
  }
  twin.stack = makeStack(twin.recordings, options);
  BaseFit newtons = base;
  newtons.noise_N.setOnes();
  twin.all_base_rows = baseRows(newtons, twin.recordings, twin.stack);
  twin.all_force_rows = forceRows(newtons, twin.recordings, twin.stack);
  setAttention(twin, Attention::Moving);
  for (int r = 0; r < count; ++r) {
    twin.inputs.push_back(effectInput(robot, twin.recordings[static_cast<std::size_t>(r)], newtons.memory, r, count));
    setModelForces(twin.inputs.back(), base, model);
  }
  for (identification::Observation& o : twin.recordings) {
    for (Eigen::MatrixXd& regressor : o.regressor)
      regressor.resize(0, 0);  // tens of megabytes that nobody needs any more
  }
  return twin;
}

/// Blocks of the real residual, all actuators together, at random places with random signs.
Eigen::VectorXd resampled(const TraceData& data, const TraceData& twin, const Eigen::VectorXd& residual,
                          std::mt19937_64& random) {
  const Eigen::Index p = data.stack.size(), to = twin.stack.size();
  const Eigen::Index block = std::clamp<Eigen::Index>(std::lround(kBlock_s * data.stack.rate_hz), 2, p);
  Eigen::VectorXd out(to * data.stack.axes);
  for (Eigen::Index at = 0; at < to; at += block) {
    const Eigen::Index from = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(p));
    const double sign = random() % 2 ? 1.0 : -1.0;
    for (Eigen::Index k = 0; k < std::min(block, to - at); ++k) {
      for (int i = 0; i < data.stack.axes; ++i)
        out[i * to + at + k] = sign * residual[i * p + (from + k) % p];
    }
  }
  return out;
}

std::vector<Place> placesOf(const std::vector<Hypothesis>& tried) {
  std::vector<Place> places;
  for (const Hypothesis& h : tried) {
    if (std::find(places.begin(), places.end(), h.place) == places.end()) places.push_back(h.place);
  }
  return places;
}

std::size_t indexOf(const std::vector<Place>& places, const Place& place) {
  return static_cast<std::size_t>(std::find(places.begin(), places.end(), place) - places.begin());
}

/// Root of the best share of every place (rows) in every draw (columns).
Eigen::MatrixXd drawsOfTwin(const TraceData& twin, const TraceData& data, const Eigen::VectorXd& residual,
                            const Eigen::VectorXd& noise_N, const std::vector<Hypothesis>& accepted,
                            const std::vector<Hypothesis>& tried, const std::vector<Place>& places, int draws,
                            std::uint64_t seed) {
  const Projection projection =
      project(modelColumns(twin, noise_N, accepted), weighted(twin.stack, twin.force_rows, noise_N));
  std::mt19937_64 random(seed);
  Eigen::MatrixXd noise(projection.residual.size(), draws);
  for (int d = 0; d < draws; ++d)
    noise.col(d) = resampled(data, twin, residual, random);
  noise -= projection.q * (projection.q.transpose() * noise).eval();
  noise.colwise() += projection.residual;
  Eigen::MatrixXd best = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(places.size()), draws);
  Eigen::Index row = 0;
  for (const std::vector<Hypothesis>& group : byPlace(tried)) {
    const Eigen::MatrixXd squares = explained(makeProbes(twin, group, projection, noise_N), noise);
    best.row(row++) = (squares.colwise().maxCoeff().cwiseMax(0.0) / static_cast<double>(twin.stack.size())).cwiseSqrt();
  }
  return best;
}

/// Largest standardized value of one draw, of the places whose value could be accepted at all.
double largestOf(const Eigen::VectorXd& values, const NullDistribution& null) {
  double largest = 0.0;
  for (Eigen::Index row = 0; row < values.size(); ++row) {
    if (values[row] >= kWorthwhile) largest = std::max(largest, (values[row] - null.mean[row]) / null.spread[row]);
  }
  return largest;
}

/// Mean and spread of every place, and the largest standardized value of every draw.
void judge(const Eigen::MatrixXd& all, NullDistribution& null) {
  null.mean = all.rowwise().mean();
  null.spread = ((all.colwise() - null.mean).rowwise().squaredNorm() / static_cast<double>(all.cols() - 1))
                    .cwiseSqrt()
                    .cwiseMax(kLeastSpread);
  null.largest.clear();
  for (Eigen::Index d = 0; d < all.cols(); ++d)
    null.largest.push_back(largestOf(all.col(d), null));
  std::sort(null.largest.begin(), null.largest.end());
}

/// Results of `task(k)` for k = 0 .. count - 1, in order, computed in two threads.
template <typename Result, typename Task>
std::vector<Result> inTwoThreads(int count, const Task& task) {
  std::vector<Result> results(static_cast<std::size_t>(count));
  const auto half = [&](int first) {
    for (int k = first; k < count; k += 2)
      results[static_cast<std::size_t>(k)] = task(k);
  };
  std::future<void> other = std::async(std::launch::async, half, 1);
  half(0);
  other.get();
  return results;
}

}  // namespace

std::vector<TraceData> makeTwins(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings,
                                 const TraceData& data, const BaseFit& base, const TwinModel& model,
                                 const std::vector<TwinPlan>& plans, const identification::ObservationOptions& options,
                                 int count, std::uint64_t seed) {
  return inTwoThreads<TraceData>(count, [&](int k) {
    return makeTwin(robot, recordings, data, base, model, plans, options,
                    seed * 7919u + static_cast<std::uint64_t>(k) + 1u);
  });
}

TwinEffects effectForces(const EffectInput& input, const TwinModel& model) {
  TwinEffects out;
  out.friction_N = out.load_N = Eigen::MatrixXd::Zero(input.samples(), input.axes());
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    Eigen::MatrixXd& kind = model.effects[k].place.candidate->isFriction() ? out.friction_N : out.load_N;
    for (int i = 0; i < input.axes(); ++i)
      kind.col(i) += effectColumns(input, model.effects[k], i) * model.coefficients[k];
  }
  return out;
}

Eigen::VectorXd twinResidual(const std::vector<TraceData>& twins, const BaseFit& base,
                             const std::vector<Hypothesis>& effects, int first) {
  const std::size_t start = static_cast<std::size_t>(first);
  Eigen::MatrixXd left(twins.front().stack.axes, static_cast<Eigen::Index>(twins.size() - start));
  for (std::size_t k = start; k < twins.size(); ++k) {
    const TraceData& twin = twins[k];
    const Projection p =
        project(modelColumns(twin, base.noise_N, effects), weighted(twin.stack, twin.force_rows, base.noise_N));
    left.col(static_cast<Eigen::Index>(k - start)) = rmsRows(base, twin.stack, p.residual);
  }
  Eigen::VectorXd median(left.rows());
  for (Eigen::Index i = 0; i < left.rows(); ++i) {
    Eigen::VectorXd row = left.row(i).transpose();
    std::sort(row.data(), row.data() + row.size());
    median[i] = row[row.size() / 2];
  }
  return median;
}

NullDistribution nullDistribution(const std::vector<TraceData>& twins, const TraceData& data,
                                  const Eigen::VectorXd& residual_N, const Eigen::VectorXd& noise_N,
                                  const std::vector<Hypothesis>& accepted, const std::vector<Hypothesis>& tried,
                                  const std::vector<Hope>& hopes, double largest_p, int draws, std::uint64_t seed) {
  const int count = static_cast<int>(twins.size());
  const int each = (draws + count - 1) / count;
  const Eigen::VectorXd residual = weighted(data.stack, residual_N, noise_N);
  NullDistribution null;
  null.places = placesOf(tried);
  Eigen::MatrixXd all(static_cast<Eigen::Index>(null.places.size()), 0);
  for (int done = 0; done < count;) {
    const int now = std::min(done == 0 ? kFirstTwins : count, count - done);
    const auto parts = inTwoThreads<Eigen::MatrixXd>(now, [&](int k) {
      return drawsOfTwin(twins[static_cast<std::size_t>(done + k)], data, residual, noise_N, accepted, tried,
                         null.places, each, seed * 104729u + static_cast<std::uint64_t>(done + k));
    });
    all.conservativeResize(Eigen::NoChange, (done + now) * each);
    for (int k = 0; k < now; ++k)
      all.middleCols((done + k) * each, each) = parts[static_cast<std::size_t>(k)];
    done += now;
    judge(all, null);
    const double most = largest_p * (1.0 + count * each) - 1.0;  // draws that may still reach a hope
    null.hopeless = std::all_of(hopes.begin(), hopes.end(), [&](const Hope& hope) {
      const double value = null.standardized(hope.first, hope.second);
      return std::count_if(null.largest.begin(), null.largest.end(), [&](double x) { return x >= value; }) >
             kSurely + most;
    });
    if (null.hopeless) break;
  }
  return null;
}

double NullDistribution::standardized(const Place& place, double share) const {
  const Eigen::Index row = static_cast<Eigen::Index>(indexOf(places, place));
  return (std::sqrt(std::max(0.0, share)) - mean[row]) / spread[row];
}

double NullDistribution::threshold(const Place& place) const {
  const Eigen::Index row = static_cast<Eigen::Index>(indexOf(places, place));
  return mean[row] + spread[row] * largest.back();
}

double monteCarloP(const std::vector<double>& null_values, double value) {
  const auto reached = null_values.end() - std::lower_bound(null_values.begin(), null_values.end(), value);
  return (1.0 + static_cast<double>(reached)) / (1.0 + static_cast<double>(null_values.size()));
}

Eigen::MatrixXd modelColumns(const TraceData& data, const Eigen::VectorXd& noise_N,
                             const std::vector<Hypothesis>& effects) {
  std::vector<Eigen::MatrixXd> rows;
  Eigen::Index columns = data.base_rows.cols();
  for (const Hypothesis& h : effects) {
    rows.push_back(effectRows(data, h));
    columns += rows.back().cols();
  }
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
