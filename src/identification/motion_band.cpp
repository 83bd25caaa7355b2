#include "knee_robot/identification/motion_band.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {
namespace {

constexpr double kWiderBands[] = {2.0, 3.0, 4.5};
constexpr double kAllowedAtLeast = 2.0;      ///< by the encoders, of motionCutoff: below, wider ones are not tried
constexpr double kShareOfSlowestRate = 0.4;  ///< of the slowest recording's: the widest
constexpr double kWorthChoosing = 0.95;      ///< of the error
constexpr double kWorthAStep = 0.99;  ///< of the error: what did not gain a hundredth will not gain five by more of it
constexpr double kTautSteps[] = {1.0, 1.5};
constexpr double kNoiseThatShows_m_per_s = 3e-5;  ///< of velocities: a third of the slowest laws' speed

double slowestRecorded(const std::vector<recording::Recording>& recordings) {
  double rate_hz = 1e9;
  for (const recording::Recording& r : recordings)
    rate_hz = std::min(rate_hz, 1.0 / recording::medianPeriod(r.time_s));
  return rate_hz;
}

/// The recordings observed in one way, what was fitted to them, and what that leaves.
struct Tried {
  double error_N = 0.0;
  std::shared_ptr<const Identification> fit;
};

/// Error: geometric mean over the actuators of the rms of what a model leaves along the positions that it was fitted
/// from, all samples, both sides low-passed: what an effect leaves on one of them hides nothing of the others.
Tried tryFit(const mechanism::Robot& robot, const std::vector<Column>& columns, std::vector<Observation> training,
             const ObservationOptions& options) {
  IdentifyOptions fit;
  fit.observation = options;
  fit.joint_friction = columns.size() > columnsOf(robot).size();
  fit.uncertainty = false;
  Tried tried;
  tried.fit = std::make_shared<const Identification>(identify(robot, training, fit));
  const Applied applied = applyModel(tried.fit->model, robot, training, options.cutoff_hz);
  tried.error_N = std::exp(applied.accuracy.rms_N.array().max(1e-12).log().mean());
  return tried;
}

/// These ways (the first: as the recordings were observed) until one hardly leaves less than the one before it, each
/// being a step further than that. `as_they_are`: the first, where it was tried already.
std::vector<Tried> tryWays(const mechanism::Robot& robot, const std::vector<Column>& columns,
                           const std::vector<recording::Recording>& recordings,
                           const std::vector<Observation>& training, const std::vector<ObservationOptions>& ways,
                           const Tried& as_they_are) {
  std::vector<Tried> tried(ways.size());
  tried.front() = as_they_are;
  const std::size_t first = as_they_are.fit ? 1 : 0;
  std::size_t done = std::min<std::size_t>(2, ways.size());
  const auto tryOne = [&](std::size_t k) {
    tried[k] = tryFit(robot, columns, k > 0 ? observeAll(robot, columns, recordings, ways[k]) : training, ways[k]);
  };
  inParallel(done - std::min(first, done), [&](std::size_t k) { tryOne(first + k); });
  for (; done < ways.size() && tried[done - 1].error_N < kWorthAStep * tried[done - 2].error_N; ++done)
    tryOne(done);
  tried.resize(done);
  return tried;
}

/// The best of the others, where it is worth it; 0: as they are.
std::size_t chosenOf(const std::vector<Tried>& tried) {
  const auto best = std::min_element(tried.begin(), tried.end(),
                                     [](const Tried& a, const Tried& b) { return a.error_N < b.error_N; });
  return best->error_N > kWorthChoosing * tried.front().error_N ? 0 : static_cast<std::size_t>(best - tried.begin());
}

std::string timesAsMuch(const std::vector<Tried>& tried, std::size_t chosen) {
  return "it leaves " + shortNumber(tried[chosen].error_N / tried.front().error_N, 2) +
         " times as much of training as ";
}

/// `options`: set to the band that is chosen. Returns what was fitted there.
Tried chooseWider(const mechanism::Robot& robot, const std::vector<Column>& columns,
                  const std::vector<recording::Recording>& recordings, const std::vector<Observation>& training,
                  ObservationOptions& options, MotionBand& band) {
  const double rate_hz = slowestRecorded(recordings), fits_hz = motionCutoff(robot, options.cutoff_hz, rate_hz);
  const double widest_hz = std::min(encodersAllow(robot, rate_hz), kShareOfSlowestRate * rate_hz);
  if (options.motion_cutoff_given || widest_hz < kAllowedAtLeast * fits_hz) return {};
  std::vector<ObservationOptions> ways = {options};
  for (const double wider : kWiderBands) {
    if (wider * fits_hz > widest_hz) continue;
    ways.push_back(options);
    ways.back().setCutoff(options.cutoff_hz, wider * fits_hz);
  }
  const std::vector<Tried> tried = tryWays(robot, columns, recordings, training, ways, {});
  const std::size_t chosen = chosenOf(tried);
  if (chosen == 0) return tried.front();
  options = ways[chosen];
  band.cutoff_hz = options.signals.motion_cutoff_hz;
  band.sentence = "Positions are low-passed at " + shortNumber(band.cutoff_hz, 3) +
                  " Hz for the fit: " + timesAsMuch(tried, chosen) + "from those at " + shortNumber(fits_hz, 3) +
                  " Hz (mean of the actuators); near rest friction follows small, fast motions.";
  return tried[chosen];
}

/// `as_they_are`: without. Returns what was fitted as is chosen.
Tried chooseTaut(const mechanism::Robot& robot, const std::vector<Column>& columns,
                 const std::vector<recording::Recording>& recordings, const std::vector<Observation>& training,
                 const ObservationOptions& options, const Tried& as_they_are, MotionBand& band) {
  const double rate_hz = slowestRecorded(recordings);
  const double cutoff_hz =
      options.motion_cutoff_given ? options.signals.motion_cutoff_hz : motionCutoff(robot, options.cutoff_hz, rate_hz);
  if (velocityNoise(robot, cutoff_hz, rate_hz) < kNoiseThatShows_m_per_s) return as_they_are;
  std::vector<ObservationOptions> ways = {options};
  for (const double steps : kTautSteps) {
    ways.push_back(options);
    ways.back().taut_steps = steps;
  }
  const std::vector<Tried> tried = tryWays(robot, columns, recordings, training, ways, as_they_are);
  const std::size_t chosen = chosenOf(tried);
  if (chosen == 0) return tried.front();
  band.taut_steps = ways[chosen].taut_steps;
  band.sentence += std::string(band.sentence.empty() ? "" : " ") +
                   "Smooth laws of friction follow the shortest line within " + shortNumber(band.taut_steps, 2) +
                   " encoder steps of the positions: " + timesAsMuch(tried, chosen) +
                   "with their low-passed velocity, in which an axis that rests trembles.";
  return tried[chosen];
}

}  // namespace

MotionBand chooseMotionBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<recording::Recording>& recordings, std::vector<Observation> training,
                            const ObservationOptions& options) {
  MotionBand band;
  ObservationOptions chosen = options;
  const Tried wider = chooseWider(robot, columns, recordings, training, chosen, band);
  if (band.cutoff_hz > 0.0) training = observeAll(robot, columns, recordings, chosen);
  band.fit = chooseTaut(robot, columns, recordings, training, chosen, wider, band).fit;
  return band;
}

}  // namespace knee_robot::identification
