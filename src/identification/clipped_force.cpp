#include "clipped_force.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"

namespace knee_robot::identification {
namespace {

constexpr double kAtLimit = 0.999;  ///< of the robot file's limit: from there on it is saturation that is known
/// Times the length of the other stretches of one value (of nine in ten of them): at the top of a coarsely rounded wave
/// the force stays at most two and a half times as long as on its flanks.
constexpr double kLonger = 3.0;
constexpr int kFewestStretches = 2;  ///< that the same value was reached twice is what tells a limit
constexpr int kFewestRows = 20;

/// Rows in which one axis' force has exactly one value.
struct Stretch {
  int from = 0, to = 0;  ///< one past the last
  double value_N = 0.0;
  int rows() const { return to - from; }
};

/// Those in most of whose rows the axis moves.
std::vector<Stretch> movingStretches(const Eigen::VectorXd& force_N, const Eigen::VectorXd& speed, double moving) {
  std::vector<Stretch> all;
  const int n = static_cast<int>(force_N.size());
  for (int from = 0, to; from < n; from = to) {
    int moves = 0;
    for (to = from; to < n && force_N[to] == force_N[from]; ++to)
      moves += speed[to] > moving;
    if (2 * moves > to - from) all.push_back({from, to, force_N[from]});
  }
  return all;
}

/// Stretches at one of the force's extremes that are long beside all others.
std::vector<Stretch> plateaus(const std::vector<Stretch>& all, double low_N, double high_N, double limit_N) {
  std::vector<int> lengths;
  for (const Stretch& s : all) {
    if (s.value_N != low_N && s.value_N != high_N) lengths.push_back(s.rows());
  }
  std::vector<Stretch> found;
  if (lengths.empty()) return found;
  const double least = kLonger * quantile(std::move(lengths), 0.9);
  int rows = 0;
  for (const Stretch& s : all) {
    const bool extreme = (s.value_N == high_N && high_N > 0.0) || (s.value_N == low_N && low_N < 0.0);
    if (!extreme || std::abs(s.value_N) >= kAtLimit * limit_N || s.rows() < least) continue;
    found.push_back(s);
    rows += s.rows();
  }
  if (static_cast<int>(found.size()) < kFewestStretches || rows < kFewestRows) found.clear();
  return found;
}

std::string whereOf(const mechanism::Actuator& a, int axis, const std::vector<Stretch>& found) {
  const std::string unit = mechanism::forceUnit(a);
  const auto at = [&](double value_N) { return shortNumber(value_N * a.force_per_N(), 4); };
  const auto [low, high] = std::minmax_element(
      found.begin(), found.end(), [](const Stretch& s, const Stretch& t) { return s.value_N < t.value_N; });
  return std::string(unit == "A"    ? "current_"
                     : unit == "Nm" ? "torque_"
                                    : "force_") +
         std::to_string(axis + 1) + "_" + unit + " stands at " + at(low->value_N) +
         (low->value_N < high->value_N ? " and " + at(high->value_N) : "") + " " + unit;
}

}  // namespace

ClippedForce findClipped(const mechanism::Robot& robot, const Eigen::VectorXd& moving_m_per_s, const Observation& o) {
  ClippedForce clipped;
  const Eigen::MatrixXd speed =
      recording::atHoldIntervals(o.signals, o.signals.velocity_m_per_s.cwiseAbs(), o.row_time_s);
  for (int i = 0; i < robot.axes(); ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const Eigen::VectorXd force_N = o.row_force_N.col(i);
    const std::vector<Stretch> found = plateaus(movingStretches(force_N, speed.col(i), moving_m_per_s[i]),
                                                force_N.minCoeff(), force_N.maxCoeff(), a.forceLimit());
    if (found.empty()) continue;
    clipped.rows.resize(o.row_time_s.size(), 0);
    for (const Stretch& s : found)
      std::fill(clipped.rows.begin() + s.from, clipped.rows.begin() + s.to, 1);
    if (clipped.where.empty()) clipped.where = whereOf(a, i, found);
  }
  return clipped;
}

}  // namespace knee_robot::identification
