#include "knee_robot/identification/accuracy.h"

#include <cmath>
#include <limits>

#include "knee_robot/recording/filter.h"

namespace knee_robot::identification {
namespace {

/// Sums over all recordings, per actuator.
struct Sums {
  explicit Sums(Eigen::Index axes)
      : error(Eigen::VectorXd::Zero(axes)),
        moving(error),
        resting(error),
        resting_samples(error),
        since_moved(error),
        since_moved_samples(error),
        raw(error),
        rows_measured(error),
        measured(error),
        largest(error),
        low(Eigen::VectorXd::Constant(axes, std::numeric_limits<double>::infinity())),
        high(-low) {}

  Eigen::VectorXd error, moving, resting, resting_samples, since_moved, since_moved_samples, raw, rows_measured,
      measured, largest, low, high;
  double samples = 0.0, moving_samples = 0.0, rows = 0.0;
};

void addSamples(const Observation& o, const Prediction& p, Sums& s) {
  if (o.judgedSamples() == 0) return;
  const Eigen::MatrixXd error = judgedOnly(o.judged, p.force_filtered_N - o.force_filtered_N);
  const Eigen::MatrixXd measured = judgedOnly(o.judged, o.force_filtered_N);
  s.error += error.colwise().squaredNorm().transpose();
  s.measured += measured.colwise().squaredNorm().transpose();
  s.largest = s.largest.cwiseMax(error.cwiseAbs().colwise().maxCoeff().transpose());
  s.low = s.low.cwiseMin(measured.colwise().minCoeff().transpose());
  s.high = s.high.cwiseMax(measured.colwise().maxCoeff().transpose());
  s.samples += static_cast<double>(error.rows());
}

void addSinceMoved(const Observation& o, const Prediction& p, Sums& s) {
  for (int i = 0; i < o.axes(); ++i) {
    bool has_moved = false;
    for (int n = 0; n < o.samples(); ++n) {
      const bool moves = o.axis_moving(n, i);
      has_moved = has_moved || moves;
      if (!has_moved || !o.isJudged(n)) continue;
      const double error = p.force_filtered_N(n, i) - o.force_filtered_N(n, i);
      s.since_moved[i] += error * error;
      s.since_moved_samples[i] += 1.0;
      if (moves || !o.usable[static_cast<std::size_t>(n)]) continue;
      s.resting[i] += error * error;
      s.resting_samples[i] += 1.0;
    }
  }
}

void add(const Observation& o, const Prediction& p, Sums& s) {
  addSamples(o, p, s);
  addSinceMoved(o, p, s);
  s.raw += judgedOnly(o.judged_rows, p.row_force_N - o.row_force_N).colwise().squaredNorm().transpose();
  s.rows_measured += judgedOnly(o.judged_rows, o.row_force_N).colwise().squaredNorm().transpose();
  s.rows += static_cast<double>(o.judgedRows());
  for (int n = 0; n < o.samples(); ++n) {
    if (!o.moving[static_cast<std::size_t>(n)] || !o.isJudged(n)) continue;
    s.moving += (p.force_filtered_N.row(n) - o.force_filtered_N.row(n)).cwiseAbs2().transpose();
    s.moving_samples += 1.0;
  }
}

}  // namespace

double Accuracy::togetherPercent() const {
  return 100.0 * rms_N.norm() / (100.0 * rms_N.cwiseQuotient(rms_percent)).norm();
}

Prediction makePrediction(const Observation& o, Eigen::MatrixXd force_N, double cutoff_hz) {
  Prediction p;
  p.force_N = std::move(force_N);
  p.force_filtered_N = p.force_N;
  recording::ZeroPhaseLowPass(cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(p.force_filtered_N);
  p.row_force_N = recording::atHoldIntervals(o.signals, p.force_N, o.row_time_s);
  return p;
}

Accuracy accuracyOf(const std::vector<Observation>& observations, const std::vector<Prediction>& predictions) {
  Sums s(observations.front().axes());
  for (std::size_t i = 0; i < observations.size(); ++i)
    add(observations[i], predictions[i], s);
  Accuracy a;
  a.samples = static_cast<int>(s.samples);
  a.moving_samples = static_cast<int>(s.moving_samples);
  a.rms_N = (s.error / s.samples).cwiseSqrt();
  a.rms_moving_N = (s.moving / s.moving_samples).cwiseSqrt();  // 0 / 0 is nan: no such sample
  a.rms_resting_N = s.resting.cwiseQuotient(s.resting_samples).cwiseSqrt();
  a.rms_since_moved_N = s.since_moved.cwiseQuotient(s.since_moved_samples).cwiseSqrt();
  a.rms_raw_N = (s.raw / s.rows).cwiseSqrt();
  a.raw_percent = 100.0 * (s.raw.array() / s.rows_measured.array()).sqrt();
  a.rms_percent = 100.0 * a.rms_N.cwiseQuotient((s.measured / s.samples).cwiseSqrt());
  a.range_percent = 100.0 * a.rms_N.cwiseQuotient(s.high - s.low);
  a.max_N = s.largest;
  return a;
}

}  // namespace knee_robot::identification
