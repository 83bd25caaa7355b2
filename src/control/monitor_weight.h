#pragma once

#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// The axis carries the opposite of what it should weigh. Where encoder_sign and force_sign are both wrong the loop is
/// closed as it should be, and the leg shortens where it is to lengthen; with the gravity of the robot file, or a model,
/// upside down the feedforward pushes the wrong way. Judged once after each enabling, by the mean force of the first
/// kLook_s of rest; of axes only whose weight friction and somebody's leg do not turn round.
class WeightMonitor {
 public:
  /// `weight_N`: what the feedforward holds against it at rest.
  bool step(const AxisView& axis, double weight_N, bool at_rest) noexcept {
    if (judged_) return false;
    if (!at_rest || std::abs(weight_N) < kLeast_N) {
      rest_s_ = looked_s_ = sum_ = 0.0;
      return false;
    }
    rest_s_ += axis.dt;
    if (rest_s_ < kSettles_s) return false;
    looked_s_ += axis.dt;
    sum_ += axis.force_N * axis.dt;
    if (looked_s_ < kLook_s) return false;
    judged_ = true;
    return sum_ / looked_s_ * (weight_N > 0.0 ? 1.0 : -1.0) < -kShare * std::abs(weight_N);
  }
  void reset() noexcept { *this = {}; }

 private:
  static constexpr double kLeast_N = 60.0;  ///< as much as friction of the leg that sticks most
  static constexpr double kShare = 0.75;    ///< a platform that a crane carries shows friction alone
  static constexpr double kSettles_s = 0.2, kLook_s = 0.5;

  bool judged_ = false;
  double rest_s_ = 0.0, looked_s_ = 0.0, sum_ = 0.0;
};

}  // namespace knee_robot::control
