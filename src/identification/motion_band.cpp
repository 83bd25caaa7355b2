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
constexpr double kWorthWidening = 0.95;      ///< of the error

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

}  // namespace

MotionBand chooseMotionBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const std::vector<recording::Recording>& recordings, std::vector<Observation> training,
                            const ObservationOptions& options) {
  const double rate_hz = slowestRecorded(recordings), fits_hz = motionCutoff(robot, options.cutoff_hz, rate_hz);
  const double widest_hz = std::min(encodersAllow(robot, rate_hz), kShareOfSlowestRate * rate_hz);
  if (options.motion_cutoff_given || widest_hz < kAllowedAtLeast * fits_hz) return {};
  std::vector<double> tried_hz = {fits_hz};
  for (const double wider : kWiderBands) {
    if (wider * fits_hz <= widest_hz) tried_hz.push_back(wider * fits_hz);
  }
  std::vector<double> error(tried_hz.size());
  inParallel(tried_hz.size(), [&](std::size_t k) {
    ObservationOptions wide = options;
    if (k > 0) wide.setCutoff(options.cutoff_hz, tried_hz[k]);
    error[k] = errorOfFit(robot, columns, k > 0 ? observeAll(robot, columns, recordings, wide) : training, wide);
  });
  const auto best = std::min_element(error.begin(), error.end());
  if (*best > kWorthWidening * error.front()) return {};
  const double best_hz = tried_hz[static_cast<std::size_t>(best - error.begin())];
  return {best_hz, "Positions are low-passed at " + shortNumber(best_hz, 3) + " Hz for the fit: it leaves " +
                       shortNumber(*best / error.front(), 2) + " times as much of training as from those at " +
                       shortNumber(fits_hz, 3) +
                       " Hz (mean of the actuators); near rest friction follows small, fast motions."};
}

}  // namespace knee_robot::identification
