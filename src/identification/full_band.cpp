#include "knee_robot/identification/full_band.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {
namespace {

constexpr double kStep = 1.5;            ///< between the low-passes that are tried
constexpr double kShareOfRate = 0.4;     ///< of the recording's rate: the highest
constexpr double kSamplesPerCycle = 10;  ///< of the grid, at the low-pass
constexpr double kWorthwhile = 0.95;     ///< of the rows' error: along another path friction at rest is another force
constexpr double kNoWorse = 1.005;       ///< of the error in the fit's band
constexpr double kNarrowest = 0.5;       ///< low-pass that is tried, of the fit's cut-off
constexpr double kDrowned = 1.5;         ///< error of the widest that was tried, of the best one
constexpr std::size_t kWiderAtOnce = 2;

/// Mean squares of one low-pass, summed over actuators in units of their force.
struct Errors {
  double rows = 0.0;  ///< not filtered
  double band = 0.0;  ///< both sides low-passed as in the fit
};

Errors errorsOf(const std::vector<Observation>& observed, const std::vector<Eigen::MatrixXd>& force_N,
                double cutoff_hz) {
  const Eigen::Index axes = observed.front().axes();
  Eigen::ArrayXd rows = Eigen::ArrayXd::Zero(axes), band = rows, recorded = rows, recorded_band = rows;
  for (std::size_t k = 0; k < observed.size(); ++k) {
    const Observation& o = observed[k];
    const Eigen::MatrixXd predicted = recording::atHoldIntervals(o.signals, force_N[k], o.row_time_s);
    rows += judgedOnly(o.judged_rows, predicted - o.row_force_N).colwise().squaredNorm().transpose().array();
    recorded += judgedOnly(o.judged_rows, o.row_force_N).colwise().squaredNorm().transpose().array();
    Eigen::MatrixXd low = force_N[k];
    recording::ZeroPhaseLowPass(cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(low);
    for (int n = 0; n < o.samples(); ++n) {
      if (!o.usable[static_cast<std::size_t>(n)]) continue;
      band += o.signals.period_s * (low.row(n) - o.force_filtered_N.row(n)).array().square().transpose();
      recorded_band += o.signals.period_s * o.force_filtered_N.row(n).array().square().transpose();
    }
  }
  return {(rows / recorded.max(1e-12)).mean(), (band / recorded_band.max(1e-12)).mean()};
}

/// That of the fit, then narrower ones.
std::vector<double> narrowerThan(double fits_hz, double cutoff_hz) {
  std::vector<double> all = {fits_hz};
  for (double hz = fits_hz / kStep; hz >= kNarrowest * cutoff_hz; hz /= kStep)
    all.push_back(hz);
  return all;
}

std::vector<double> widerThan(double fits_hz, double rate_hz) {
  std::vector<double> all;
  for (double hz = fits_hz * kStep; hz <= kShareOfRate * rate_hz; hz *= kStep)
    all.push_back(hz);
  return all;
}

/// Noise of positions, differentiated twice, is most of the error of the last and widest, and more of wider ones.
bool isDrowned(const std::vector<Errors>& errors) {
  double least = errors.front().rows;
  for (const Errors& e : errors)
    least = std::min(least, e.rows);
  return errors.back().rows > kDrowned * kDrowned * least;
}

std::string sentenceOf(const FullBand& b, double chosen_hz, double error) {
  return "Rows are predicted from positions low-passed at " + shortNumber(chosen_hz, 3) +
         " Hz, the fit from positions at " + shortNumber(b.tried_hz.front(), 3) +
         " Hz; error of the training rows, forces unfiltered, " + shortNumber(100.0 * b.error.front(), 3) +
         (b.motion_cutoff_hz > 0.0 ? " -> " + shortNumber(100.0 * error, 3) : "") + " % of their rms.";
}

}  // namespace

ObservationOptions fullBandOptions(const ObservationOptions& fit, double motion_cutoff_hz) {
  ObservationOptions options = fit;
  if (fit.motion_cutoff_given) options.signals.path_cutoff_hz = fit.signals.motion_cutoff_hz;
  options.motion_cutoff_given = true;
  options.signals.motion_cutoff_hz = motion_cutoff_hz;
  options.signals.rate_hz = std::max(fit.signals.rate_hz, kSamplesPerCycle * motion_cutoff_hz);
  return options;
}

FullBand chooseFullBand(const mechanism::Robot& robot, const std::vector<Column>& columns,
                        const std::vector<recording::Recording>& training, const ObservationOptions& fit,
                        const RowPredictor& predict) {
  double rate_hz = 1e9;
  for (const recording::Recording& r : training)
    rate_hz = std::min(rate_hz, 1.0 / recording::medianPeriod(r.time_s));
  const double fits_hz =
      fit.motion_cutoff_given ? fit.signals.motion_cutoff_hz : motionCutoff(robot, fit.cutoff_hz, rate_hz);
  FullBand band;
  std::vector<Errors> errors;
  const auto judge = [&](const std::vector<double>& low_passes) {
    std::vector<Errors> these(low_passes.size());
    inParallel(these.size(), [&](std::size_t tried) {
      std::vector<Observation> observed;
      std::vector<Eigen::MatrixXd> force_N;
      for (std::size_t k = 0; k < training.size(); ++k) {
        observed.push_back(observe(robot, columns, training[k], fullBandOptions(fit, low_passes[tried])));
        force_N.push_back(predict(observed.back(), static_cast<int>(k)));
      }
      these[tried] = errorsOf(observed, force_N, fit.cutoff_hz);
    });
    band.tried_hz.insert(band.tried_hz.end(), low_passes.begin(), low_passes.end());
    errors.insert(errors.end(), these.begin(), these.end());
  };
  judge(narrowerThan(fits_hz, fit.cutoff_hz));
  // The wider, the finer the grid: a few of them, until noise alone is worse than all that a narrower one lacks.
  const std::vector<double> wider = widerThan(fits_hz, rate_hz);
  for (std::size_t from = 0; from < wider.size() && (from == 0 || !isDrowned(errors)); from += kWiderAtOnce) {
    const auto first = wider.begin() + static_cast<std::ptrdiff_t>(from);
    judge({first, first + static_cast<std::ptrdiff_t>(std::min(kWiderAtOnce, wider.size() - from))});
  }
  const double worthwhile = kWorthwhile * kWorthwhile, no_worse = kNoWorse * kNoWorse;
  Errors best = errors.front();
  double chosen_hz = fits_hz;
  for (std::size_t tried = 0; tried < errors.size(); ++tried) {
    const Errors& now = errors[tried];
    band.error.push_back(std::sqrt(now.rows));
    if (now.rows > worthwhile * best.rows || now.band > no_worse * errors.front().band) continue;
    best = now;
    chosen_hz = band.motion_cutoff_hz = band.tried_hz[tried];
  }
  band.sentence = sentenceOf(band, chosen_hz, std::sqrt(best.rows));
  return band;
}

Eigen::MatrixXd predictRows(const mechanism::Robot& robot, const std::vector<Column>& columns,
                            const recording::Recording& recording, const ObservationOptions& fit,
                            double motion_cutoff_hz, const RowPredictor& predict, int index) {
  Observation o = observe(robot, columns, recording, fullBandOptions(fit, motion_cutoff_hz));
  return recording::atHoldIntervals(o.signals, predict(o, index), o.row_time_s);
}

}  // namespace knee_robot::identification
