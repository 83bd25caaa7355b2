#include "knee_robot/recording/jumps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/quantile.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::recording {
namespace {

constexpr double kFarBeyond =
    3.0;  ///< times the speed limit: limits in robot files are set with a margin below the drives'
constexpr double kStandsOut =
    5.0;  ///< times the median speed of the steps around: a motion that is fast for long is none
constexpr double kStandsOutFar = 20.0;   ///< times the fastest of them: no acceleration limit allows that
constexpr int kAround = 3;               ///< steps on either side
constexpr int kWindow = 5;               ///< rows on either side over which stamps that come in bursts are evened out
constexpr double kLongestHold_s = 0.02;  ///< a fast recorder writes a slower encoder's value again and again
constexpr double kEncoderSteps = 20.0;   ///< smaller steps may be one reading of a coarse encoder
constexpr double kFrozen_s = 1.0;        ///< shorter: an axis may have rested
constexpr double kRests = 0.2;  ///< of a frozen stretch's length; where an axis rests as long elsewhere, it may rest

/// One axis: its steps from row to row.
class Steps {
 public:
  Steps(const Recording& r, int first, int axis) : r_(r), first_(first), axis_(axis) {
    std::vector<double> holds;
    double changed_s = time(first), smallest = std::numeric_limits<double>::infinity();
    for (int k = first; k + 1 < r.rows(); ++k) {
      const double change = std::abs(step(k));
      if (change < kNothing_m) continue;
      smallest = std::min(smallest, change);
      holds.push_back(time(k + 1) - changed_s);
      changed_s = time(k + 1);
    }
    hold_s_ = holds.empty() ? 0.0 : std::min(kLongestHold_s, median(std::move(holds)));
    least_m_ = kEncoderSteps * smallest;
  }

  double time(int row) const { return r_.time_s[static_cast<std::size_t>(row)]; }
  double step(int k) const { return r_.position_m(k + 1, axis_) - r_.position_m(k, axis_); }
  double leastJump() const { return least_m_; }

  /// Speed of the step after row k, over the time that it may have taken.
  double speed(int k) const {
    const int from = std::max(first_, k - kWindow), to = std::min(r_.rows() - 1, k + 1 + kWindow);
    const double usual = (time(to) - time(from)) / (to - from);
    return step(k) / std::max({time(k + 1) - time(k), usual, hold_s_});
  }

  /// Speeds of the steps around that after row k, without it.
  std::vector<double> around(int k) const {
    std::vector<double> speeds;
    for (int j = std::max(first_, k - kAround); j <= std::min(r_.rows() - 2, k + kAround); ++j) {
      if (j != k) speeds.push_back(speed(j));
    }
    return speeds;
  }

  /// First of the rows up to `row` that have exactly its position.
  int standsFrom(int row) const {
    while (row > first_ && step(row - 1) == 0.0)
      --row;
    return row;
  }

  /// Longest time at exactly one position that does not end at `row`, s.
  double longestElsewhere(int row) const {
    double longest = 0.0, since = time(first_);
    for (int k = first_; k < r_.rows(); ++k) {
      if (k + 1 < r_.rows() && step(k) == 0.0) continue;
      if (k != row) longest = std::max(longest, time(k) - since);
      if (k + 1 < r_.rows()) since = time(k + 1);
    }
    return longest;
  }

 private:
  static constexpr double kNothing_m = 1e-9;

  const Recording& r_;
  int first_, axis_;
  double hold_s_ = 0.0, least_m_ = 0.0;
};

bool isJump(const Steps& steps, int k, double fastest_m_per_s) {
  const double speed = std::abs(steps.speed(k));
  if (speed <= fastest_m_per_s || std::abs(steps.step(k)) < steps.leastJump()) return false;
  std::vector<double> around = steps.around(k);
  for (double& v : around)
    v = std::abs(v);
  if (around.empty()) return false;
  const double fastest = *std::max_element(around.begin(), around.end());
  return speed > kStandsOutFar * fastest ||
         (speed > kFarBeyond * fastest_m_per_s && speed > kStandsOut * median(around));
}

Jump jumpAt(const Steps& steps, int k, int axis) {
  Jump jump;
  jump.axis = axis;
  jump.row = k + 1;
  jump.step_m = steps.step(k);
  jump.m_per_s = std::abs(steps.speed(k));
  jump.from_s = steps.time(k);
  jump.to_s = steps.time(k + 1);
  jump.beyond_m = jump.step_m - median(steps.around(k)) * (jump.to_s - jump.from_s);
  const double stood_s = jump.from_s - steps.time(steps.standsFrom(k));
  if (stood_s < kFrozen_s || steps.longestElsewhere(k) > kRests * stood_s) return jump;
  jump.frozen_s = stood_s;
  jump.from_s -= stood_s;
  return jump;
}

}  // namespace

std::vector<Jump> findJumps(const Recording& r, int first, const std::vector<double>& fastest_m_per_s) {
  std::vector<Jump> jumps;
  for (int i = 0; i < static_cast<int>(std::min<std::size_t>(fastest_m_per_s.size(), r.position_m.cols())); ++i) {
    const double fastest = fastest_m_per_s[static_cast<std::size_t>(i)];
    if (!(fastest > 0.0) || !std::isfinite(fastest)) continue;
    const Steps steps(r, first, i);
    for (int k = first; k + 1 < r.rows(); ++k) {
      if (isJump(steps, k, fastest)) jumps.push_back(jumpAt(steps, k, i));
    }
  }
  return jumps;
}

Eigen::MatrixXd jumpsUntil(const std::vector<Jump>& jumps, const std::vector<double>& times_s, Eigen::Index axes) {
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(times_s.size()), axes);
  for (const Jump& jump : jumps) {
    const auto from = std::lower_bound(times_s.begin(), times_s.end(), jump.to_s);
    if (from != times_s.end()) added(from - times_s.begin(), jump.axis) += jump.beyond_m;
  }
  for (Eigen::Index n = 1; n < added.rows(); ++n)
    added.row(n) += added.row(n - 1);
  return added;
}

}  // namespace knee_robot::recording
