#pragma once

#include <algorithm>
#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// The axis moves away from its reference although the force pushes towards it more than it did: a wrong sign of
/// encoder, drive or wiring (the loop then drives itself away), a drive that gives no force although it is enabled (the
/// load takes the axis along), or something outside that is stronger than the drive. Broken when, for time_s, the error
/// is above error_m, the axis itself moves away from the reference faster than `speed`, seen from the base and from the
/// moving reference, and has not become slower; and it is then faster by `acceleration` on average, or pushed back by a
/// `share` of the force limit more than at the beginning (or by all there is) without effect. An axis that only lags
/// behind a fast reference moves towards it, one that runs a little ahead of it keeps its distance, one that overshoots
/// becomes slower or is about to, and so does one that somebody pushes against a healthy loop.
class RunawayMonitor {
 public:
  bool step(const AxisView& axis, double error_m, double speed, double acceleration, double share,
            double time_s) noexcept {
    const double error = axis.reference_m - axis.position_m;
    const double side = error > 0.0 ? -1.0 : 1.0;
    const double away = std::min(side * axis.velocity, side * (axis.velocity - axis.reference_velocity));  // m/s
    const double push_N = -side * axis.force_N;  // towards the reference
    const bool leaves = std::abs(error) > error_m && away > speed && away >= largest_away_ - kWaver_m_per_s;
    const bool long_enough = running_.step(leaves, axis.dt, time_s);
    if (!leaves) {
      away_before_ = largest_away_ = away;
      push_before_N_ = push_N;
      return false;
    }
    largest_away_ = std::max(largest_away_, away);
    const double more_N = push_N - push_before_N_, faster = away - away_before_;
    const bool clamped = std::abs(axis.force_N) >= 0.999 * axis.force_limit_N;
    return long_enough && ((clamped && faster >= 0.0) || more_N >= share * axis.force_limit_N ||
                           (more_N > 0.0 && faster >= acceleration * running_.time_s()));
  }
  /// The axis is running away now, though not long enough to be sure.
  bool suspects() const noexcept { return running_.isTrue(); }
  void reset() noexcept { *this = {}; }

 private:
  static constexpr double kWaver_m_per_s = 0.0007;  ///< of a steady velocity that is estimated from counts

  TrueFor running_;
  double away_before_ = 0.0, push_before_N_ = 0.0;  ///< when it began to leave
  double largest_away_ = 0.0;                       ///< m/s, since then
};

}  // namespace knee_robot::control
