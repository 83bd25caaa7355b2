#include "knee_robot/recording/signals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/recording/filter.h"
#include "taut_string.h"

namespace knee_robot::recording {
namespace {

constexpr int kFewestRows = 20;
constexpr double kNoJitter_s = 1e-9;  ///< less is the rounding of stamps
constexpr double kTrembleWindow_s = 0.2;
constexpr double kFarthest_s = 0.05;
constexpr int kLastStaleRow = 50;                 ///< a recorder's stale rows are the first few
constexpr double kImpossibleJump_m = 1e-3;        ///< between neighbouring rows,
constexpr double kBurst = 20.0;                   ///< mean intervals; a recording without a longer one has no gap
constexpr double kImpossibleSpeed_m_per_s = 2.0;  ///< and at this speed: no actuator moved so, the older row is stale
constexpr double kLeastStroke_m = 1e-3, kSamePlace_m = 1e-9;

std::string percent(double share) {
  return shortNumber(100.0 * share, 3) + " %";
}

/// Number of rows at the start that do not belong to the motion: a jump or a long pause follows them.
int staleRows(const Recording& r, double longest_pause_s) {
  int stale = 0;
  const int last = std::min(kLastStaleRow, r.rows() / 4);
  for (int k = 0; k < last; ++k) {
    const double dt = r.time_s[k + 1] - r.time_s[k];
    const double jump = (r.position_m.row(k + 1) - r.position_m.row(k)).cwiseAbs().maxCoeff();
    if (dt > longest_pause_s || (jump > kImpossibleJump_m && jump > kImpossibleSpeed_m_per_s * dt)) stale = k + 1;
  }
  return stale;
}

/// Index k of the row with time[k] <= t < time[k + 1], advancing from `k`; stays within [0, size - 2].
int advance(const std::vector<double>& time, double t, int k) {
  while (k + 2 < static_cast<int>(time.size()) && time[k + 1] <= t)
    ++k;
  return k;
}

/// Slope at row k of the parabola through it and its nearest neighbours at least `reach` away: an encoder's step is as
/// steep as it is near, and a slope is carried over an interval as long as the one that it is for. Beyond kFarthest_s
/// nobody looks at it: that is a gap, and may be hours.
Eigen::RowVectorXd slopeAt(const std::vector<double>& time, const Eigen::MatrixXd& x, int k, double reach) {
  const int n = static_cast<int>(time.size());
  reach = std::min(reach, kFarthest_s);
  int a = std::max(k - 1, 0);
  int b = std::min(k + 1, n - 1);
  while (a > 0 && time[k] - time[a] < reach)
    --a;
  while (b < n - 1 && time[b] - time[k] < reach)
    ++b;
  if (a == k || b == k) return (x.row(b) - x.row(a)) / (time[b] - time[a]);
  const double before = time[k] - time[a];
  const double after = time[b] - time[k];
  return ((x.row(k) - x.row(a)) / before * after + (x.row(b) - x.row(k)) / after * before) / (before + after);
}

/// Cubic Hermite interpolation of row values at the times of `grid`.
Eigen::MatrixXd sampleCubic(const std::vector<double>& time, const Eigen::MatrixXd& x,
                            const std::vector<double>& grid) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(grid.size()), x.cols());
  int k = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    k = advance(time, grid[i], k);
    const double h = time[k + 1] - time[k];
    const double s = std::clamp((grid[i] - time[k]) / h, 0.0, 1.0);
    const double s2 = s * s;
    const double s3 = s2 * s;
    out.row(static_cast<Eigen::Index>(i)) =
        (2 * s3 - 3 * s2 + 1) * x.row(k) + (s3 - 2 * s2 + s) * h * slopeAt(time, x, k, h / 2) +
        (3 * s2 - 2 * s3) * x.row(k + 1) + (s3 - s2) * h * slopeAt(time, x, k + 1, h / 2);
  }
  return out;
}

std::vector<double> uniformGrid(double from, double to, double period) {
  const std::size_t count = static_cast<std::size_t>(std::floor((to - from) / period + 1e-6)) + 1;
  std::vector<double> grid(count);
  for (std::size_t i = 0; i < count; ++i)
    grid[i] = from + period * static_cast<double>(i);
  return grid;
}

Eigen::MatrixXd everyNth(const Eigen::MatrixXd& x, int step, int count) {
  Eigen::MatrixXd out(count, x.cols());
  for (int i = 0; i < count; ++i)
    out.row(i) = x.row(static_cast<Eigen::Index>(i) * step);
  return out;
}

/// Where each row's share of the time begins, when a row stands for the time around it.
std::vector<double> midpoints(const std::vector<double>& time) {
  std::vector<double> out = time;
  for (std::size_t k = 1; k < time.size(); ++k)
    out[k] = 0.5 * (time[k - 1] + time[k]);
  return out;
}

/// Way per time of `raw` beyond that of `smooth`, over a window around every sample.
Eigen::MatrixXd trembleOf(const Eigen::MatrixXd& raw, const Eigen::MatrixXd& smooth, double period) {
  const Eigen::Index n = raw.rows(), half = std::max<Eigen::Index>(1, std::lround(0.5 * kTrembleWindow_s / period));
  Eigen::MatrixXd beyond = Eigen::MatrixXd::Zero(n, raw.cols());  // up to each sample
  for (Eigen::Index k = 1; k < n; ++k)
    beyond.row(k) =
        beyond.row(k - 1) + (raw.row(k) - raw.row(k - 1)).cwiseAbs() - (smooth.row(k) - smooth.row(k - 1)).cwiseAbs();
  Eigen::MatrixXd out(n, raw.cols());
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index from = std::max<Eigen::Index>(0, k - half), to = std::min(n - 1, k + half);
    out.row(k) = (beyond.row(to) - beyond.row(from)).cwiseMax(0.0) / (period * static_cast<double>(to - from));
  }
  return out;
}

/// Marks grid samples inside long intervals without rows and at jumps (`gap`), and those of test pulses.
void markUnknown(const std::vector<double>& time, double longest_s, const Eigen::VectorXd& test_pulse, Signals& s) {
  s.gap.assign(s.time_s.size(), 0);
  s.known.assign(s.time_s.size(), 1);
  int k = 0;
  for (std::size_t i = 0; i < s.time_s.size(); ++i) {
    k = advance(time, s.time_s[i], k);
    s.gap[i] = time[k + 1] - time[k] > longest_s;
    if (test_pulse.size() > 0 && test_pulse[k] != 0.0) s.known[i] = 0;
  }
  for (const Jump& jump : s.jumps) {
    const auto sample = [&](double time_s) { return (time_s - s.time_s.front()) / s.period_s; };
    const int from = static_cast<int>(std::floor(sample(jump.from_s))),
              to = static_cast<int>(std::ceil(sample(jump.to_s)));
    for (int i = std::max(0, from); i <= std::min(s.samples() - 1, to); ++i)
      s.gap[static_cast<std::size_t>(i)] = 1;
  }
  for (std::size_t i = 0; i < s.gap.size(); ++i)
    s.known[i] = s.known[i] && !s.gap[i];
}

void warn(std::string sentence, Signals& s) {
  s.notes.push_back(sentence);
  s.warnings.push_back(std::move(sentence));
}

void noteTiming(const std::vector<double>& time, double period, int rows_left_out, Signals& s) {
  std::size_t late = 0;
  double longest = 0.0;
  double sum_of_squares = 0.0;
  for (std::size_t k = 0; k + 1 < time.size(); ++k) {
    const double dt = time[k + 1] - time[k];
    longest = std::max(longest, dt);
    if (dt > 1.5 * period) ++late;
    if (dt <= 1.5 * period) sum_of_squares += (dt - period) * (dt - period);
  }
  const double jitter = std::sqrt(sum_of_squares / static_cast<double>(time.size()));
  s.notes.push_back(
      "Rows arrive every " + shortNumber(1e3 * period, 4) + " ms (median, jitter " +
      shortNumber(jitter < kNoJitter_s ? 0.0 : 1e3 * jitter, 3) + " ms rms); " + std::to_string(late) +
      " interval(s) longer than 1.5 periods, the longest " + shortNumber(1e3 * longest, 4) + " ms. Resampled to " +
      shortNumber(1.0 / s.period_s, 4) + " Hz (" + std::to_string(s.samples()) +
      " samples): positions by a cubic at their own times, commands averaged over the time they were held.");
  if (rows_left_out > 0) warn("The first " + std::to_string(rows_left_out) + " row(s) are stale and were left out.", s);
  const auto unknown = std::count(s.gap.begin(), s.gap.end(), 1);
  if (unknown > 0)
    warn(percent(static_cast<double>(unknown) / s.samples()) + " of the samples lie in gaps and are not used.", s);
}

/// Smallest change between neighbouring rows of each axis: the encoder's step, where the motion is slow enough to show
/// it.
void noteQuantization(const Eigen::MatrixXd& position, double period, const SignalOptions& options, Signals& s) {
  std::string steps, left;
  // White rounding noise of step / root(12), of which a low-pass at f keeps the share 2 f * period of the power.
  const double kept = std::sqrt(std::min(1.0, 2.0 * options.motion_cutoff_hz * period));
  for (Eigen::Index i = 0; i < position.cols(); ++i) {
    double smallest = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k + 1 < position.rows(); ++k) {
      const double change = std::abs(position(k + 1, i) - position(k, i));
      if (change > 1e-9) smallest = std::min(smallest, change);
    }
    if (!std::isfinite(smallest)) smallest = 0.0;
    steps += (i ? ", " : "") + shortNumber(1e6 * smallest, 3);
    left += (i ? ", " : "") + shortNumber(1e6 * smallest / std::sqrt(12.0) * kept, 2);
  }
  s.notes.push_back("Positions come in steps of " + steps + " um; rounded to these, the low-pass at " +
                    shortNumber(options.motion_cutoff_hz) + " Hz leaves an error of about " + left +
                    " um rms. Coulomb friction does not reverse within a step or two.");
}

/// No machine is exactly where it is told to be: such positions were not measured, or the reference was written after
/// them. Who reads the friction and the frequencies of such a recording should know.
void noteReferencesThatArePositions(const Recording& r, Signals& s) {
  if (r.reference_m.size() == 0) return;
  std::string actuators;
  for (int i = 0; i < r.axes; ++i) {
    const bool moves = r.position_m.col(i).maxCoeff() - r.position_m.col(i).minCoeff() > kLeastStroke_m;
    if (moves && (r.position_m.col(i) - r.reference_m.col(i)).cwiseAbs().maxCoeff() < kSamePlace_m)
      actuators += (actuators.empty() ? "" : ", ") + std::to_string(i + 1);
  }
  if (actuators.empty()) return;
  warn("Position and reference are the same in every row of actuator " + actuators +
           ": was the position measured, or one of the two columns exported twice?",
       s);
}

/// Why a recording has far fewer rows than its median interval promises: long gaps, or stamps that come in bursts.
Refusal tooSparse(const std::string& path, const std::vector<double>& time, double period) {
  const double span = time.back() - time.front(), usual = span / static_cast<double>(time.size() - 1);
  double longest = 0.0;
  for (std::size_t k = 0; k + 1 < time.size(); ++k)
    longest = std::max(longest, time[k + 1] - time[k]);
  if (longest < kBurst * usual) {
    return Refusal(path +
                   ": its stamps come in bursts, not when the rows were measured: the median interval of time_s is " +
                   shortNumber(1e3 * period, 3) + " ms, but there is one row every " + shortNumber(1e3 * usual, 3) +
                   " ms; record the time of each measurement, with at least 1 ms resolution");
  }
  return Refusal(path + ": its rows cover only a small part of its " + shortNumber(span) +
                 " s; cut the recording at its long gaps");
}

}  // namespace

double medianPeriod(const std::vector<double>& time) {
  std::vector<double> steps(time.size() - 1);
  for (std::size_t k = 0; k < steps.size(); ++k)
    steps[k] = time[k + 1] - time[k];
  return median(std::move(steps));
}

Eigen::MatrixXd heldMeans(const std::vector<double>& time, const Eigen::MatrixXd& values,
                          const std::vector<double>& centers, double width) {
  const int n = static_cast<int>(time.size());
  Eigen::MatrixXd integral = Eigen::MatrixXd::Zero(n, values.cols());  // up to each row's time
  for (int k = 1; k < n; ++k)
    integral.row(k) = integral.row(k - 1) + values.row(k - 1) * (time[k] - time[k - 1]);
  const auto until = [&](double t) -> Eigen::RowVectorXd {
    const auto next = std::upper_bound(time.begin(), time.end(), t);
    const int k = std::max(0, static_cast<int>(next - time.begin()) - 1);
    return integral.row(k) + values.row(k) * (t - time[k]);
  };
  Eigen::MatrixXd out(static_cast<Eigen::Index>(centers.size()), values.cols());
  for (std::size_t i = 0; i < centers.size(); ++i) {
    out.row(static_cast<Eigen::Index>(i)) = (until(centers[i] + width / 2) - until(centers[i] - width / 2)) / width;
  }
  return out;
}

Signals resample(const Recording& r, const Eigen::MatrixXd& force_N, const SignalOptions& options) {
  const auto tooShort = [&](int rows) {
    return Refusal(r.path + ": " + std::to_string(rows) + " usable rows are too few, at least " +
                   std::to_string(kFewestRows) + " are needed; record a longer motion");
  };
  if (r.rows() < kFewestRows) throw tooShort(r.rows());
  const double period = medianPeriod(r.time_s);
  const double longest = std::max(options.gap_periods * period, options.gap_cycles / options.motion_cutoff_hz);
  const int stale = staleRows(r, longest);
  const int rows = r.rows() - stale;
  if (rows < kFewestRows) throw tooShort(rows);
  const std::vector<double> time(r.time_s.begin() + stale, r.time_s.end());

  const double span = time.back() - time.front();
  if (span / period > 20.0 * rows + 1000.0) throw tooSparse(r.path, time, period);
  const std::vector<double> fine = uniformGrid(time.front(), time.back(), period);
  const std::vector<Jump> jumps = findJumps(r, stale, options.fastest_m_per_s);
  const Eigen::MatrixXd recorded = r.position_m.bottomRows(rows);
  const Eigen::MatrixXd raw =
      sampleCubic(time, jumps.empty() ? recorded : recorded - jumpsUntil(jumps, time, recorded.cols()), fine);
  Eigen::MatrixXd position = raw;
  ZeroPhaseLowPass(options.motion_cutoff_hz, 1.0 / period, Continuation::Parabola).applyToColumns(position);

  Signals s;
  const int step = std::max(1, static_cast<int>(std::floor(1.0 / (period * options.rate_hz) + 0.01)));
  const int count = (static_cast<int>(fine.size()) - 1) / step + 1;
  s.period_s = period * step;
  s.motion_cutoff_hz = options.motion_cutoff_hz;
  s.time_s.resize(count);
  for (int i = 0; i < count; ++i)
    s.time_s[i] = fine[static_cast<std::size_t>(i) * step];
  s.position_m = everyNth(position, step, count);
  s.jumps = jumps;
  if (!jumps.empty()) s.position_m += jumpsUntil(jumps, s.time_s, recorded.cols());
  s.velocity_m_per_s = everyNth(firstDerivative(position, period), step, count);
  Eigen::MatrixXd path = position;
  const double path_hz = std::max(options.path_cutoff_hz, options.motion_cutoff_hz);
  if (path_hz > options.motion_cutoff_hz) {
    path = raw;
    ZeroPhaseLowPass(path_hz, 1.0 / period, Continuation::Parabola).applyToColumns(path);
    s.path_m = everyNth(path, step, count);
    if (!jumps.empty()) s.path_m += jumpsUntil(jumps, s.time_s, recorded.cols());
    s.path_velocity_m_per_s = everyNth(firstDerivative(path, period), step, count);
  }
  if (!options.taut_m.empty()) {
    Eigen::MatrixXd line = raw;
    for (Eigen::Index i = 0; i < line.cols(); ++i)
      line.col(i) = tautString(raw.col(i), options.taut_m[static_cast<std::size_t>(i)]);
    ZeroPhaseLowPass(path_hz, 1.0 / period, Continuation::Parabola).applyToColumns(line);
    s.taut_m = everyNth(line, step, count);
    if (!jumps.empty()) s.taut_m += jumpsUntil(jumps, s.time_s, recorded.cols());
    s.taut_velocity_m_per_s = everyNth(firstDerivative(line, period), step, count);
  }
  s.acceleration_m_per_s2 = everyNth(secondDerivative(position, period), step, count);
  if (r.motor_m.cols() > 0) {
    Eigen::MatrixXd motor = sampleCubic(time, r.motor_m.bottomRows(rows), fine);
    ZeroPhaseLowPass(options.motion_cutoff_hz, 1.0 / period, Continuation::Parabola).applyToColumns(motor);
    s.motor_m = everyNth(motor, step, count);
  }
  if (r.temperature_degC.cols() > 0)
    s.temperature_degC = everyNth(sampleCubic(time, r.temperature_degC.bottomRows(rows), fine), step, count);
  s.force_is_measured = r.force_is_measured;
  s.force_N = heldMeans(r.force_is_measured ? midpoints(time) : time, force_N.bottomRows(rows), s.time_s, s.period_s);
  s.tremble_m_per_s = everyNth(trembleOf(raw, path, period), step, count);
  markUnknown(time, longest, r.test_pulse.tail(r.test_pulse.size() > 0 ? rows : 0), s);
  s.rounding_left = std::clamp(6.0 * std::sqrt(2.0 * path_hz * period / 12.0), 0.25, 1.0);
  s.notes = r.notes;
  noteQuantization(r.position_m.bottomRows(rows), period, options, s);
  noteTiming(time, period, stale, s);
  noteReferencesThatArePositions(r, s);
  return s;
}

Eigen::MatrixXd atHoldIntervals(const Signals& s, const Eigen::MatrixXd& values, const std::vector<double>& row_time) {
  const double usual = row_time.size() > 1 ? medianPeriod(row_time) : s.period_s;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(row_time.size()), values.cols());
  for (std::size_t k = 0; k < row_time.size(); ++k) {
    const double hold = k + 1 < row_time.size() ? std::min(row_time[k + 1] - row_time[k], 2.0 * usual) : usual;
    const double middle = s.force_is_measured ? row_time[k] : row_time[k] + hold / 2;
    const double place = (middle - s.time_s.front()) / s.period_s;
    const double inside = std::clamp(place, 0.0, static_cast<double>(s.samples() - 1));
    const int i = std::min(static_cast<int>(inside), s.samples() - 2);
    const double f = inside - i;
    out.row(static_cast<Eigen::Index>(k)) = (1.0 - f) * values.row(i) + f * values.row(i + 1);
  }
  return out;
}

}  // namespace knee_robot::recording
