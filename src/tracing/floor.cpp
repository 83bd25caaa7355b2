#include "floor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/recording/filter.h"
#include "repeated_friction.h"
#include "repeats.h"

namespace knee_robot::tracing {
namespace {

/// Of the rms force; above what DAC and encoder steps leave. Where repeats show the noise, less: an actuator that carries
/// the platform's weight would otherwise hide what is told on its neighbours.
constexpr double kEngineeringShare = 0.003, kMeasuredShare = 0.001;
constexpr double kBlock_s = 1.0;   ///< of differences between repeats: several correlation times
constexpr Eigen::Index kMass = 4;  ///< first moments and mass, the last four of the platform's parameters
constexpr double kEvent = 9.0;     ///< factor of the median square above which a block is an event, not noise

/// Standard deviation in pieces of a second, of which the lower quartile counts: bursts at reversals do not.
double quietSpread(const Eigen::VectorXd& signal, Eigen::Index piece) {
  std::vector<double> spreads;
  for (Eigen::Index at = 0; at + piece <= signal.size(); at += piece)
    spreads.push_back(signal.segment(at, piece).norm() / std::sqrt(static_cast<double>(piece)));
  if (spreads.empty()) return 0.0;
  return quantile(std::move(spreads), 0.25);
}

/// White noise below the cut-off, from the band between 3 and 6 times it.
double densityEstimate(const identification::Observation& o, const Eigen::VectorXd& residual, double cutoff_hz) {
  const double rate = 1.0 / o.signals.period_s;
  Eigen::VectorXd high = residual, low = residual;
  recording::ZeroPhaseLowPass(6.0 * cutoff_hz, rate).apply(high);
  recording::ZeroPhaseLowPass(3.0 * cutoff_hz, rate).apply(low);
  return quietSpread(high - low, static_cast<Eigen::Index>(rate)) / std::sqrt(3.0);  // the band is three cut-offs wide
}

/// Squared differences between repeats, per actuator, block by block. Noise is alike everywhere; what is larger in few
/// blocks happened in one run and not in the other: an event, to be traced.
class RepeatDifferences {
 public:
  explicit RepeatDifferences(int axes) : squares_(static_cast<std::size_t>(axes)) {}

  void add(const Eigen::MatrixXd& differences, Eigen::Index block) {
    for (Eigen::Index at = 0; at + block <= differences.rows(); at += block) {
      for (std::size_t i = 0; i < squares_.size(); ++i)
        squares_[i].push_back(0.5 * differences.col(static_cast<Eigen::Index>(i)).segment(at, block).squaredNorm() /
                              static_cast<double>(block));
    }
  }
  bool empty() const { return squares_.front().empty(); }
  /// Mean over the blocks that are no events: noise has bursts too, which a median would leave out.
  double noise_N(int actuator) const {
    std::vector<double> own = squares_[static_cast<std::size_t>(actuator)];
    std::sort(own.begin(), own.end());
    const double limit = kEvent * own[own.size() / 2];
    const auto end = std::upper_bound(own.begin(), own.end(), limit);
    return std::sqrt(std::accumulate(own.begin(), end, 0.0) / static_cast<double>(end - own.begin()));
  }
  double eventShare(int actuator) const {
    std::vector<double> own = squares_[static_cast<std::size_t>(actuator)];
    std::sort(own.begin(), own.end());
    const double limit = kEvent * own[own.size() / 2];
    return static_cast<double>(own.end() - std::upper_bound(own.begin(), own.end(), limit)) /
           static_cast<double>(own.size());
  }

 private:
  std::vector<std::vector<double>> squares_;
};

/// Share of dry friction and velocity of every actuator, low-passed as differences are.
struct Travel {
  Eigen::MatrixXd share, velocity;
};

Travel travelOf(const EffectInput& input, double cutoff_hz) {
  Travel t = {input.share, input.signals().velocity_m_per_s};
  const recording::ZeroPhaseLowPass filter(cutoff_hz, 1.0 / input.signals().period_s);
  filter.applyToColumns(t.share);
  filter.applyToColumns(t.velocity);
  return t;
}

/// What nobody would look for: this small share of the force, per actuator.
Eigen::VectorXd shareOfForce(const TraceData& data, double share) {
  const double root = std::sqrt(static_cast<double>(data.stack.size()));
  Eigen::VectorXd size(data.stack.axes);
  for (int i = 0; i < data.stack.axes; ++i)
    size[i] = share * gatherForce(data.stack, data.recordings, i).norm() / root;
  return size;
}

/// What the floor is measured and estimated from.
struct Given {
  const std::vector<recording::Recording>& recordings;
  const TraceData& data;
  std::vector<Eigen::MatrixXd> residual_N;  ///< per recording, not low-passed

  Eigen::Index blockOf(std::size_t r) const {
    return std::max<Eigen::Index>(2, std::lround(kBlock_s / data.recordings[r].signals.period_s));
  }
  void lowPass(std::size_t r, Eigen::MatrixXd& columns) const {
    recording::ZeroPhaseLowPass(data.stack.cutoff_hz, 1.0 / data.recordings[r].signals.period_s)
        .applyToColumns(columns);
  }
};

/// What the platform's first moments and mass ask of every actuator, low-passed; empty where there is no platform.
std::vector<Eigen::MatrixXd> carriedAlong(const Given& given, std::size_t r, const RepeatedRun& run) {
  const identification::Observation& o = given.data.recordings[r];
  std::vector<Eigen::MatrixXd> out;
  for (int i = 0; o.motion.coupled && !given.data.inputs[r].robot->chain && i < o.axes(); ++i) {
    Eigen::MatrixXd carried =
        o.regressor[static_cast<std::size_t>(i)].middleCols(dynamics::kInertialParameters - kMass, kMass);
    given.lowPass(r, carried);
    out.push_back(carried.middleRows(run.first_a, run.samples));
  }
  return out;
}

/// What differs between the runs of one reference and is no noise, rms N.
struct Systematic {
  Eigen::VectorXd friction_N;  ///< per actuator
  double payload_N = 0.0;      ///< of the actuator with the largest
};

/// Adds what two recordings of one reference differ by, but for friction that differs slowly between them and another
/// payload, of which the largest are kept in `most`.
void addRepeatedRun(const Given& given, std::size_t a, std::size_t b, RepeatDifferences& differences, Systematic& most,
                    std::string& source) {
  const TraceData& data = given.data;
  const RepeatedRun run =
      findRepeatedRun(given.recordings[a], data.recordings[a].signals, given.recordings[b], data.recordings[b].signals);
  const Eigen::Index n = run.samples;
  if (n == 0) return;
  Eigen::MatrixXd difference =
      given.residual_N[a].middleRows(run.first_a, n) - given.residual_N[b].middleRows(run.first_b, n);
  given.lowPass(a, difference);
  const std::vector<Eigen::MatrixXd> carried = carriedAlong(given, a, run);
  if (!carried.empty()) most.payload_N = std::max(most.payload_N, takeOutPayloadOfRuns(carried, difference));
  const Travel travel = travelOf(data.inputs[a], data.stack.cutoff_hz);
  most.friction_N = most.friction_N.cwiseMax(takeOutFrictionOfRuns(
      travel.share.middleRows(run.first_a, n), travel.velocity.middleRows(run.first_a, n), difference));
  differences.add(difference, given.blockOf(a));
  source += (source.empty() ? "repeats of one reference: " : "; ") + given.recordings[a].name + " and " +
            given.recordings[b].name;
}

/// Adds what the cycles of one recording that repeats one differ by.
void addRepeatedCycle(const Given& given, std::size_t r, RepeatDifferences& differences, std::string& source) {
  const recording::Signals& signals = given.data.recordings[r].signals;
  const RepeatedCycle cycle = findRepeatedCycle(given.recordings[r], signals);
  if (cycle.lag == 0) return;
  Eigen::MatrixXd filtered = given.residual_N[r];
  given.lowPass(r, filtered);
  const std::vector<char>& usable = given.data.recordings[r].usable;
  Eigen::MatrixXd difference(static_cast<Eigen::Index>(cycle.first.size()), filtered.cols());
  Eigen::Index kept = 0;
  for (const int n : cycle.first) {
    if (!usable[static_cast<std::size_t>(n)] || !usable[static_cast<std::size_t>(n + cycle.lag)]) continue;
    difference.row(kept++) = filtered.row(n + cycle.lag) - filtered.row(n);
  }
  differences.add(difference.topRows(kept), given.blockOf(r));
  source += (source.empty() ? "" : "; ") + given.recordings[r].name + " repeats a cycle of " +
            shortNumber(cycle.lag * signals.period_s, 3) + " s within itself (" +
            shortNumber(static_cast<double>(cycle.first.size()) * signals.period_s, 3) + " s compared)";
}

/// From repeats; `taken`: out of their differences.
Eigen::VectorXd measuredFloor(const RepeatDifferences& differences, const Systematic& taken, std::string& source) {
  Eigen::VectorXd rms_N(taken.friction_N.size());
  double events = 0.0;
  for (int i = 0; i < rms_N.size(); ++i) {
    rms_N[i] = differences.noise_N(i);
    events = std::max(events, differences.eventShare(i));
  }
  if (events > 0.0)
    source += "; without events, " + shortNumber(100.0 * events, 2) +
              " % of the time, in which the repeats differ by more than three times their noise";
  if (taken.friction_N.maxCoeff() > 0.0)
    source += "; without friction that differs between the recordings, " +
              shortNumber(taken.friction_N.maxCoeff() / std::sqrt(2.0), 2) + " N at most";
  if (taken.payload_N > 0.0)
    source += "; without a payload that differs between the recordings, " +
              shortNumber(taken.payload_N / std::sqrt(2.0), 2) + " N at most";
  return rms_N;
}

/// Where nothing repeats.
Eigen::VectorXd estimatedFloor(const Given& given, const Eigen::VectorXd& surrogate_residual_N, std::string& source) {
  source =
      "no repeated reference; estimated from what surrogates leave and from the noise of the force between 3 and 6 "
      "times the cut-off";
  Eigen::VectorXd rms_N(surrogate_residual_N.size());
  for (int i = 0; i < rms_N.size(); ++i) {
    double noise = 0.0;
    for (std::size_t r = 0; r < given.recordings.size(); ++r)
      noise +=
          std::pow(densityEstimate(given.data.recordings[r], given.residual_N[r].col(i), given.data.stack.cutoff_hz),
                   2) /
          static_cast<double>(given.recordings.size());
    rms_N[i] = std::sqrt(noise + surrogate_residual_N[i] * surrogate_residual_N[i]);
  }
  return rms_N;
}

}  // namespace

NoiseFloor noiseFloor(const std::vector<recording::Recording>& recordings, const TraceData& data,
                      const std::vector<Eigen::MatrixXd>& model_force_N, const Eigen::VectorXd& surrogate_residual_N) {
  Given given = {recordings, data, {}};
  for (std::size_t r = 0; r < recordings.size(); ++r)
    given.residual_N.push_back(data.recordings[r].signals.force_N - model_force_N[r]);
  NoiseFloor floor;
  RepeatDifferences differences(data.stack.axes);
  Systematic taken = {Eigen::VectorXd::Zero(data.stack.axes)};
  for (std::size_t a = 0; a < recordings.size(); ++a) {
    for (std::size_t b = a + 1; b < recordings.size(); ++b)
      addRepeatedRun(given, a, b, differences, taken, floor.source);
  }
  for (std::size_t r = 0; r < recordings.size(); ++r)
    addRepeatedCycle(given, r, differences, floor.source);
  floor.measured = !differences.empty();
  floor.rms_N = floor.measured ? measuredFloor(differences, taken, floor.source)
                               : estimatedFloor(given, surrogate_residual_N, floor.source);
  floor.of_names_N = floor.rms_N.cwiseMax(shareOfForce(data, kEngineeringShare));
  floor.rms_N = floor.measured ? floor.rms_N.cwiseMax(shareOfForce(data, kMeasuredShare)) : floor.of_names_N;
  return floor;
}

}  // namespace knee_robot::tracing
