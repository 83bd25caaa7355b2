#include "knee_robot/identification/axis_response.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {
namespace {

constexpr double kSlowestRate_hz = 200.0;
constexpr double kShortest_s = 2.0;
constexpr double kLongestDelay_s = 0.02, kEarliest_s = -0.002, kDelayStep_s = 0.00025;
constexpr int kPieces = 8;
constexpr double kReach = 0.4;   // of the low-pass, in periods of its cut-off
constexpr double kApart = 0.05;  // least eigenvalue of the accelerations' correlations over the largest
constexpr double kCutoffs_hz[] = {60.0, 40.0, 25.0, 15.0, 10.0};
constexpr double kNoiseShare = 0.1;      // of the acceleration's rms that rounding may have
constexpr double kOtherShare = 0.2;      // another axis' acceleration that counts
constexpr double kLeastExplained = 0.8;  // of the force's variance
constexpr double kMassTolerance = 0.15;  // largest standard error of the mass
constexpr double kDelayTolerance_s = 0.001;

/// Everything on one grid, low-passed alike.
struct Grid {
  double period_s, cutoff_hz;
  std::vector<double> time_s;
  Eigen::MatrixXd position, velocity, acceleration, sign, force;
  Eigen::MatrixXd commanded;  // acceleration of the references; of the positions where there are none
  int edge;
  int rows() const { return static_cast<int>(time_s.size()); }
};

/// Rounding of an encoder, uniform over one count, after the low-pass and two derivatives: white noise of count /
/// sqrt(12).
double roundingAcceleration(double count, double cutoff_hz, double rate_hz) {
  const double w = kTwoPi * cutoff_hz;
  return count / std::sqrt(12.0) * w * w * std::sqrt(2.0 * cutoff_hz / rate_hz / 5.0);
}

Eigen::MatrixXd interpolated(const recording::Recording& r, const Eigen::MatrixXd& values,
                             const std::vector<double>& times) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(times.size()), r.axes);
  std::size_t at = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    while (at + 2 < r.time_s.size() && r.time_s[at + 1] < times[k])
      ++at;
    const double share = std::clamp((times[k] - r.time_s[at]) / (r.time_s[at + 1] - r.time_s[at]), 0.0, 1.0);
    const auto row = static_cast<Eigen::Index>(at);
    out.row(static_cast<Eigen::Index>(k)) = (1.0 - share) * values.row(row) + share * values.row(row + 1);
  }
  return out;
}

Grid gridOf(const recording::Recording& r, const Eigen::MatrixXd& force, double period) {
  Grid grid{period, 0.0, {}, {}, {}, {}, {}, {}, {}, 0};
  for (double t = r.time_s.front(); t <= r.time_s.back(); t += period)
    grid.time_s.push_back(t);
  grid.position = interpolated(r, r.position_m, grid.time_s);
  grid.commanded = r.reference_m.cols() > 0 ? interpolated(r, r.reference_m, grid.time_s) : grid.position;
  grid.force = recording::heldMeans(r.time_s, force, grid.time_s, period);
  return grid;
}

void lowPass(Grid& grid, double cutoff_hz, double speed) {
  const recording::ZeroPhaseLowPass filter(cutoff_hz, 1.0 / grid.period_s);
  grid.cutoff_hz = cutoff_hz;
  grid.edge = filter.edgeSamples() + static_cast<int>(kLongestDelay_s / grid.period_s) + 1;
  filter.applyToColumns(grid.position);
  filter.applyToColumns(grid.force);
  filter.applyToColumns(grid.commanded);
  grid.commanded = recording::secondDerivative(grid.commanded, grid.period_s);
  grid.velocity = recording::firstDerivative(grid.position, grid.period_s);
  grid.acceleration = recording::secondDerivative(grid.position, grid.period_s);
  grid.sign = grid.velocity.unaryExpr([speed](double v) { return std::clamp(v / speed, -1.0, 1.0); });
  filter.applyToColumns(grid.sign);
}

/// The force `delay` later: what the command of a row became.
Eigen::VectorXd delayed(const Eigen::VectorXd& force, double samples) {
  Eigen::VectorXd out(force.size());
  for (Eigen::Index k = 0; k < force.size(); ++k) {
    const double at = std::clamp(static_cast<double>(k) - samples, 0.0, static_cast<double>(force.size() - 1) - 1e-9);
    const auto i = static_cast<Eigen::Index>(at);
    out[k] = force[i] + (at - static_cast<double>(i)) * (force[i + 1] - force[i]);
  }
  return out;
}

/// Least squares of one axis, block by block, for every delay that is tried.
class Fit {
 public:
  Fit(const Grid& grid, int axis, double speed) : grid_(grid) {
    columns_.push_back(grid.acceleration.col(axis));
    columns_.push_back(grid.velocity.col(axis));
    columns_.push_back(grid.sign.col(axis));
    columns_.push_back(Eigen::VectorXd::Ones(grid.rows()));
    const int reach = std::min(grid.edge, static_cast<int>(kReach / grid.cutoff_hz / grid.period_s));
    for (int k = grid.edge; k < grid.rows() - grid.edge; ++k) {
      // Rest is friction that nobody knows: none of it within the low-pass' reach.
      const double slowest = std::min({std::abs(grid.velocity(k - reach, axis)), std::abs(grid.velocity(k, axis)),
                                       std::abs(grid.velocity(k + reach, axis))});
      if (slowest > speed) used_.push_back(k);
    }
    const double own = usedRms(columns_.front());
    accelerations_ = {0};
    for (int j = 0; j < static_cast<int>(grid.position.cols()); ++j) {
      if (j == axis || !(usedRms(grid.commanded.col(j)) > kOtherShare * own)) continue;
      accelerations_.push_back(static_cast<Eigen::Index>(columns_.size()));
      columns_.push_back(grid.acceleration.col(j));
    }
    matrix_.resize(static_cast<Eigen::Index>(used_.size()), static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      for (std::size_t k = 0; k < used_.size(); ++k)
        matrix_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) = columns_[c][used_[k]];
    }
    const Eigen::VectorXd force = grid.force.col(axis);
    for (double delay = kEarliest_s; delay <= kLongestDelay_s; delay += kDelayStep_s)
      addDelay(delay, delayed(force, delay / grid.period_s));
  }

  Eigen::Index rows() const { return matrix_.rows(); }
  /// Own acceleration and those of the other axes, scaled to length 1: are they told apart?
  bool isCollinear() const {
    Eigen::MatrixXd scaled(rows(), static_cast<Eigen::Index>(accelerations_.size()));
    for (Eigen::Index c = 0; c < scaled.cols(); ++c)
      scaled.col(c) = matrix_.col(accelerations_[static_cast<std::size_t>(c)]).normalized();
    const Eigen::VectorXd values = (scaled.transpose() * scaled).selfadjointView<Eigen::Lower>().eigenvalues();
    return !(values.minCoeff() > kApart * values.maxCoeff());
  }

  struct Result {
    double delay;
    Eigen::VectorXd values;
    double explained;
  };
  /// Without block `left_out`; -1: with all of them.
  Result solve(int left_out) const {
    std::vector<double> cost;
    std::vector<Eigen::VectorXd> values;
    for (std::size_t d = 0; d < delays_.size(); ++d) {
      const Sums s = sum(d, left_out);
      values.push_back(s.normal.ldlt().solve(s.right));
      cost.push_back(std::max(0.0, s.square - values.back().dot(s.right)));
    }
    const auto best = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    const Sums s = sum(best, left_out);
    const double variance = s.square - s.total * s.total / s.count;
    Result result{delays_[best], values[best], 1.0 - cost[best] / std::max(1e-12, variance)};
    if (best > 0 && best + 1 < delays_.size()) {  // the parabola through the best and its neighbours
      const double a = cost[best - 1], b = cost[best], c = cost[best + 1], curve = a - 2.0 * b + c;
      if (curve > 0.0) result.delay += 0.5 * kDelayStep_s * (a - c) / curve;
    }
    return result;
  }
  Eigen::VectorXd model(const Eigen::VectorXd& values) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(grid_.rows());
    for (std::size_t c = 0; c < columns_.size(); ++c)
      out += values[static_cast<Eigen::Index>(c)] * columns_[c];
    return out;
  }

 private:
  struct Sums {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
    double square = 0.0, total = 0.0, count = 0.0;
  };

  double usedRms(const Eigen::VectorXd& column) const {
    double square = 0.0;
    for (const int k : used_)
      square += column[k] * column[k];
    return std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, used_.size())));
  }
  void addDelay(double delay, const Eigen::VectorXd& force) {
    delays_.push_back(delay);
    Eigen::VectorXd y(rows());
    for (Eigen::Index k = 0; k < rows(); ++k)
      y[k] = force[used_[static_cast<std::size_t>(k)]];
    for (int b = 0; b < kPieces; ++b) {
      const Eigen::Index from = rows() * b / kPieces, count = rows() * (b + 1) / kPieces - from;
      const auto block = matrix_.middleRows(from, count);
      const auto part = y.segment(from, count);
      sums_.push_back({block.transpose() * block, block.transpose() * part, part.squaredNorm(), part.sum(),
                       static_cast<double>(count)});
    }
  }
  Sums sum(std::size_t delay, int left_out) const {
    const auto columns = static_cast<Eigen::Index>(columns_.size());
    Sums all{Eigen::MatrixXd::Zero(columns, columns), Eigen::VectorXd::Zero(columns), 0.0, 0.0, 0.0};
    for (int b = 0; b < kPieces; ++b) {
      if (b == left_out) continue;
      const Sums& one = sums_[delay * kPieces + static_cast<std::size_t>(b)];
      all.normal += one.normal;
      all.right += one.right;
      all.square += one.square;
      all.total += one.total;
      all.count += one.count;
    }
    return all;
  }

  const Grid& grid_;
  std::vector<Eigen::VectorXd> columns_;
  std::vector<Eigen::Index> accelerations_;  // columns
  std::vector<int> used_;
  Eigen::MatrixXd matrix_;
  std::vector<double> delays_;
  std::vector<Sums> sums_;
};

/// Standard error by the jackknife.
double jackknife(const std::vector<double>& values) {
  double mean = 0.0, square = 0.0;
  for (const double v : values)
    mean += v / static_cast<double>(values.size());
  for (const double v : values)
    square += (v - mean) * (v - mean);
  return std::sqrt(square * static_cast<double>(values.size() - 1) / static_cast<double>(values.size()));
}

void respond(const Fit& fit, const Fit::Result& all, AxisResponse& r) {
  std::vector<double> mass, viscous, coulomb, delay;
  for (int b = 0; b < kPieces; ++b) {
    const Fit::Result part = fit.solve(b);
    mass.push_back(part.values[0]);
    viscous.push_back(part.values[1]);
    coulomb.push_back(part.values[2]);
    delay.push_back(part.delay);
  }
  r.mass_kg = all.values[0];
  r.mass_std = jackknife(mass);
  r.viscous_N_s_per_m = all.values[1];
  r.viscous_std = jackknife(viscous);
  r.coulomb_N = all.values[2];
  r.coulomb_std = jackknife(coulomb);
  r.delay_s = all.delay;
  r.delay_std = jackknife(delay);
  r.explained = all.explained;
}

std::string whyNot(const AxisResponse& r) {
  if (!(r.explained >= kLeastExplained))
    return "mass, friction and a delay explain only " + shortNumber(100.0 * r.explained, 3) +
           " % of its force; record quick moves of this axis without anybody on the robot";
  if (!(r.mass_kg > 0.0) || !(r.mass_std < kMassTolerance * r.mass_kg))
    return "its inertia is " + shortNumber(r.mass_kg, 3) + " kg +- " + shortNumber(r.mass_std, 2) +
           ", which is too uncertain; record quicker moves, or more of them";
  if (!(r.delay_std < kDelayTolerance_s) || r.delay_s > kLongestDelay_s - kDelayStep_s)
    return "its delay is " + shortNumber(1e3 * r.delay_s, 3) + " ms +- " + shortNumber(1e3 * r.delay_std, 2) +
           ", which is too uncertain; record quicker moves, or more of them";
  return "";
}

void require(const recording::Recording& r, double period) {
  if (r.force_N.cols() == 0 && r.command_V.cols() == 0)
    throw Refusal(r.path + ": there is no commanded force; record with the controller's recorder");
  if (r.time_s.back() - r.time_s.front() < kShortest_s)
    throw Refusal(r.path + ": " + shortNumber(r.time_s.back() - r.time_s.front(), 3) +
                  " s are too short for gains; record at least " + shortNumber(kShortest_s) + " s of quick moves");
  if (!(1.0 / period >= kSlowestRate_hz - 0.5))
    throw Refusal(r.path + ": " + shortNumber(1.0 / period, 3) +
                  " rows a second show neither the delay nor quick moves; record at least " +
                  shortNumber(kSlowestRate_hz) + " a second");
}

/// Of the acceleration while the axis moves: rests and the other axes' turns say nothing.
double movingRms(const Grid& grid, int axis) {
  const Eigen::ArrayXd speed = grid.velocity.col(axis).array().abs();
  const Eigen::ArrayXd moves = (speed > 0.1 * speed.maxCoeff()).cast<double>();
  return std::sqrt((moves * grid.acceleration.col(axis).array().square()).sum() / std::max(1.0, moves.sum()));
}

/// The highest low-pass at which rounding is small beside an axis' motion.
double chooseCutoff(const Grid& raw, int axis, double count) {
  for (const double cutoff : kCutoffs_hz) {
    Grid grid = raw;
    lowPass(grid, cutoff, 1.0);
    if (movingRms(grid, axis) * kNoiseShare > roundingAcceleration(count, cutoff, 1.0 / raw.period_s)) return cutoff;
  }
  return kCutoffs_hz[std::size(kCutoffs_hz) - 1];
}

}  // namespace

AxisResponses axisResponses(const mechanism::Robot& robot, const recording::Recording& recording) {
  recording::requireAxes(recording, robot.axes(), robot.path);
  const double period = recording::medianPeriod(recording.time_s);
  require(recording, period);
  std::vector<double> per_volt;
  for (const mechanism::Actuator& a : robot.actuators)
    per_volt.push_back(a.force_sign * a.force_per_volt_N);
  const Grid raw = gridOf(recording, recording::commandedForce(recording, per_volt), period);
  AxisResponses out;
  out.period_s = period;
  Grid grid = raw;
  out.time_s = raw.time_s;
  out.force_N = out.model_N = Eigen::MatrixXd::Zero(raw.rows(), robot.axes());
  for (int i = 0; i < robot.axes(); ++i) {
    const double count = robot.actuators[static_cast<std::size_t>(i)].metresPerCount();
    const double cutoff = chooseCutoff(raw, i, count), noise = roundingAcceleration(count, cutoff, 1.0 / period);
    const double speed = std::max(0.001, 5.0 * noise / (kTwoPi * cutoff));
    grid = raw;
    lowPass(grid, cutoff, speed);
    out.axes.emplace_back();
    out.axes.back().cutoff_hz = cutoff;
    out.axes.back().position_mean_m = raw.position.col(i).mean();
    out.reasons.emplace_back();
    const Fit fit(grid, i, speed);
    const auto least = static_cast<Eigen::Index>(0.5 / period);
    if (fit.rows() < least || movingRms(grid, i) * kNoiseShare < noise) {
      out.reasons.back() = "it hardly moves in this recording, or too slowly for its inertia to be felt";
      continue;
    }
    if (fit.isCollinear()) {
      out.reasons.back() = "it moves together with another axis all the time; record the axes one after the other";
      continue;
    }
    const Fit::Result all = fit.solve(-1);
    respond(fit, all, out.axes.back());
    out.reasons.back() = whyNot(out.axes.back());
    out.force_N.col(i) = delayed(grid.force.col(i), all.delay / period);
    out.model_N.col(i) = fit.model(all.values);
  }
  return out;
}

}  // namespace knee_robot::identification
