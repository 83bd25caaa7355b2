#include "knee_robot/identification/motion_band.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/identify.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {
namespace {

constexpr double kWiderBands[] = {2.0, 3.0, 4.5};
constexpr double kAllowedAtLeast = 2.0;      ///< by the encoders, of motionCutoff: below, wider ones are not tried
constexpr double kShareOfSlowestRate = 0.4;  ///< of the slowest recording's: the widest
constexpr double kWorthChoosing = 0.95;      ///< of the error
constexpr double kTautSteps[] = {1.0, 1.5};
constexpr double kNoiseThatShows_m_per_s = 3e-5;  ///< of velocities: a third of the slowest laws' speed

double slowestRecorded(const std::vector<recording::Recording>& recordings) {
  double rate_hz = 1e9;
  for (const recording::Recording& r : recordings)
    rate_hz = std::min(rate_hz, 1.0 / recording::medianPeriod(r.time_s));
  return rate_hz;
}

/// Geometric mean over the actuators of the rms of what a model leaves along the positions that it was fitted from, all
/// samples, both sides low-passed: what an effect leaves on one of them hides nothing of the others.
double errorOfFit(const mechanism::Robot& robot, const std::vector<Column>& columns, std::vector<Observation> training,
                  const ObservationOptions& options) {
  IdentifyOptions fit;
  fit.observation = options;
  fit.joint_friction = columns.size() > columnsOf(robot).size();
  fit.uncertainty = false;
  const Identification id = identify(robot, training, fit);
  const Applied applied = applyModel(id.model, robot, training, options.cutoff_hz);
  return std::exp(applied.accuracy.rms_N.array().max(1e-12).log().mean());
}

/// The recordings observed in each of these ways (the first: as they are), and what a model fitted to them leaves.
std::vector<double> errorsOf(const mechanism::Robot& robot, const std::vector<Column>& columns,
                             const std::vector<recording::Recording>& recordings,
                             const std::vector<Observation>& training, const std::vector<ObservationOptions>& ways) {
  std::vector<double> error(ways.size());
  inParallel(error.size(), [&](std::size_t k) {
    error[k] = errorOfFit(robot, columns, k > 0 ? observeAll(robot, columns, recordings, ways[k]) : training, ways[k]);
  });
  return error;
}

/// The best of the others, where it is worth it; 0: as they are.
std::size_t chosenOf(const std::vector<double>& error) {
  const auto best = std::min_element(error.begin(), error.end());
  return *best > kWorthChoosing * error.front() ? 0 : static_cast<std::size_t>(best - error.begin());
}

std::string timesAsMuch(const std::vector<double>& error, std::size_t chosen) {
  return "it leaves " + shortNumber(error[chosen] / error.front(), 2) + " times as much of training as ";
}

/// `options`: set to the band that is chosen.
void chooseWider(const mechanism::Robot& robot, const std::vector<Column>& columns,
                 const std::vector<recording::Recording>& recordings, const std::vector<Observation>& training,
                 ObservationOptions& options, MotionBand& band) {
  const double rate_hz = slowestRecorded(recordings), fits_hz = motionCutoff(robot, options.cutoff_hz, rate_hz);
  const double widest_hz = std::min(encodersAllow(robot, rate_hz), kShareOfSlowestRate * rate_hz);
  if (options.motion_cutoff_given || widest_hz < kAllowedAtLeast * fits_hz) return;
  std::vector<ObservationOptions> ways = {options};
  for (const double wider : kWiderBands) {
    if (wider * fits_hz > widest_hz) continue;
    ways.push_back(options);
    ways.back().setCutoff(options.cutoff_hz, wider * fits_hz);
  }
  const std::vector<double> error = errorsOf(robot, columns, recordings, training, ways);
  const std::size_t chosen = chosenOf(error);
  if (chosen == 0) return;
  options = ways[chosen];
  band.cutoff_hz = options.signals.motion_cutoff_hz;
  band.sentence = "Positions are low-passed at " + shortNumber(band.cutoff_hz, 3) +
                  " Hz for the fit: " + timesAsMuch(error, chosen) + "from those at " + shortNumber(fits_hz, 3) +
                  " Hz (mean of the actuators); near rest friction follows small, fast motions.";
}

void chooseTaut(const mechanism::Robot& robot, const std::vector<Column>& columns,
                const std::vector<recording::Recording>& recordings, const std::vector<Observation>& training,
                const ObservationOptions& options, MotionBand& band) {
  const double rate_hz = slowestRecorded(recordings);
  const double cutoff_hz =
      options.motion_cutoff_given ? options.signals.motion_cutoff_hz : motionCutoff(robot, options.cutoff_hz, rate_hz);
  if (velocityNoise(robot, cutoff_hz, rate_hz) < kNoiseThatShows_m_per_s) return;
  std::vector<ObservationOptions> ways = {options};
  for (const double steps : kTautSteps) {
    ways.push_back(options);
    ways.back().taut_steps = steps;
  }
  const std::vector<double> error = errorsOf(robot, columns, recordings, training, ways);
  const std::size_t chosen = chosenOf(error);
  if (chosen == 0) return;
  band.taut_steps = ways[chosen].taut_steps;
  band.sentence += std::string(band.sentence.empty() ? "" : " ") +
                   "Smooth laws of friction follow the shortest line within " + shortNumber(band.taut_steps, 2) +
                   " encoder steps of the positions: " + timesAsMuch(error, chosen) +
                   "with their low-passed velocity, in which an axis that rests trembles.";
}

}  // namespace

MotionBand chooseMotionBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<recording::Recording>& recordings, std::vector<Observation> training,
                            const ObservationOptions& options) {
  MotionBand band;
  ObservationOptions chosen = options;
  chooseWider(robot, columns, recordings, training, chosen, band);
  if (band.cutoff_hz > 0.0) training = observeAll(robot, columns, recordings, chosen);
  chooseTaut(robot, columns, recordings, training, chosen, band);
  return band;
}

}  // namespace knee_robot::identification
